#include <fascia/skin/grid/grid_wrap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/grid/grid_kernels.h>

namespace fascia {
namespace {

// The width over which ways of points on different solids are evened out, as a share of the grid's
// shorter side (one standard deviation). Less leaves creases between solids that were moved apart,
// more leaves small solids behind.
constexpr double kEvenShare = 0.05;
constexpr int kMostPasses = 64;  // caps the cost on very fine grids
// Leaving one solid may enter its neighbour.
constexpr int kPushPasses = 3;

// Maps material coordinates of a solid as it was wrapped to those of what it is now.
class MatterMap {
 public:
  MatterMap(const Flesh& from, const Flesh& to, SolidId solid)
      : from_(from.restSolid(solid)),
        to_(to.restSolid(solid)),
        same_(from.def(solid).solid == to.def(solid).solid) {}

  Vec3 operator()(const Vec3& material) const {
    return same_ ? material : to_.localFromMaterial(from_.materialFromLocal(material));
  }

 private:
  const Solid &from_, &to_;
  bool same_;
};

std::vector<TissueAnchors::Anchor> mapped(const std::vector<TissueAnchors::Anchor>& anchors,
                                          const Flesh& from, const Flesh& to) {
  std::vector<MatterMap> maps;
  for (std::size_t s = 0; s < from.solidCount(); ++s)
    maps.emplace_back(from, to, SolidId(static_cast<std::int64_t>(s)));
  std::vector<TissueAnchors::Anchor> out = anchors;
  for (TissueAnchors::Anchor& a : out)
    if (a.solid.valid()) a.material = maps[a.solid.index()](a.material);
  return out;
}

// Where a ring's points go when it becomes another: moved, scaled and turned as little as possible.
class RingMotion {
 public:
  RingMotion(const EndRing& from, const EndRing& to) : from_(from.center_m), to_(to.center_m) {
    const Mat3 turn =
        Eigen::Quaterniond::FromTwoVectors(from.axis, to.axis).normalized().toRotationMatrix();
    map_ = to.radius_m / from.radius_m * turn;
    if (from.axis == to.axis) map_ = to.radius_m / from.radius_m * Mat3::Identity();
  }
  Vec3 wayOf(const Vec3& p) const { return to_ - from_ + (map_ * (p - from_) - (p - from_)); }

 private:
  Vec3 from_, to_;
  Mat3 map_;
};

template <class Visit>
void forEachStored(const GridLayout& g, int rowBegin, int rowEnd, const Visit& visit) {
  for (int j = rowBegin; j < rowEnd; ++j)
    for (int i = 0; i < g.columns; ++i) visit(g.at(i, j));
}

// The mean of each inner point's neighbours, again and again; end rows stay.
void evenOut(const GridLayout& g, FloatArray& values) {
  const double sigma = kEvenShare * std::min(g.columns, g.rows);
  const int passes = std::clamp(static_cast<int>(std::lround(2 * sigma * sigma)), 1, kMostPasses);
  FloatArray next = values;
  for (int pass = 0; pass < passes; ++pass) {
    for (int j = 1; j + 1 < g.rows; ++j) {
      const float *row = values.data() + g.row(j), *below = values.data() + g.row(j - 1),
                  *above = values.data() + g.row(j + 1);
      float* out = next.data() + g.row(j);
      for (int i = 0; i < g.columns; ++i)
        out[i] = 0.25f * (row[i - 1] + row[i + 1] + below[i] + above[i]);
    }
    fillPads(g, next);
    std::swap(values, next);
  }
}

bool anyWay(const VectorArray& way) {
  const auto moves = [](const FloatArray& a) {
    return std::any_of(a.begin(), a.end(), [](float v) { return v != 0; });
  };
  return moves(way.x) || moves(way.y) || moves(way.z);
}

// How far the matter that points are in has gone.
VectorArray waysOfMatter(const GridWrap& wrap, const FollowInput& input,
                         const std::vector<TissueAnchors::Anchor>& placements) {
  VectorArray way(wrap.rest.size()), scratch;
  TissueAnchors(placements).place(input.posedFlesh, scratch, way);
  for (const auto axis : VectorArray::kAxes)
    for (std::size_t k = 0; k < way.size(); ++k) (way.*axis)[k] -= (wrap.placed.*axis)[k];
  return way;
}

// Whether all matter is where it was: then it has gone no way.
bool isAsWrapped(const GridWrap& wrap, const FollowInput& input) {
  for (std::size_t s = 0; s < wrap.flesh.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    const Solid &was = wrap.posedFlesh.solid(id), &is = input.posedFlesh.solid(id);
    if (wrap.flesh.def(id).solid != input.flesh.def(id).solid ||
        wrap.posedFlesh.frame(id) != input.posedFlesh.frame(id))
      return false;
    for (std::size_t i = 0; i < was.parameterCount(); ++i)
      if (was.parameter(static_cast<int>(i)) != is.parameter(static_cast<int>(i))) return false;
  }
  return true;
}

void setEndWays(const GridWrap& wrap, const FollowInput& input, VectorArray& way) {
  const GridLayout& g = wrap.layout;
  for (int e = 0; e < 2; ++e) {
    const RingMotion motion(wrap.ends[e], input.ends[e]);
    const int row = e == 0 ? 0 : g.rows - 1;
    forEachStored(g, row, row + 1,
                  [&](std::size_t k) { setPoint(way, k, motion.wayOf(pointAt(wrap.rest, k))); });
  }
}

// Few points lie together in a small box, which few solids are near to.
constexpr std::size_t kPushedTogether = 32;

bool isNear(const Box& a, const Box& b, double reach_m) {
  return ((a.low.array() - reach_m) <= b.high.array()).all() &&
         ((a.high.array() + reach_m) >= b.low.array()).all();
}

// Points that lie together to a distance of the fat from every solid.
void pushOut(const DistanceField& field, std::span<const Box> boxes, float fat_m,
             const Vectors& points) {
  std::array<float, kPushedTogether> distance;
  std::array<std::array<float, kPushedTogether>, 3> normal;
  const Vectors normals{normal[0].data(), normal[1].data(), normal[2].data(), points.count};
  bool moved = true;
  for (int pass = 0; moved && pass < kPushPasses; ++pass) {
    moved = false;
    Box here;
    for (std::size_t i = 0; i < points.count; ++i)
      here.add(Vec3(points.x[i], points.y[i], points.z[i]));
    for (std::size_t s = 0; s < field.solidCount(); ++s) {
      if (!isNear(here, boxes[s], double{fat_m})) continue;
      field.evaluate(SolidId(static_cast<std::int64_t>(s)), points, distance.data(), normals);
      for (std::size_t i = 0; i < points.count; ++i) {
        const float depth = fat_m - distance[i];
        if (!(depth > 0)) continue;
        points.x[i] += depth * normals.x[i];
        points.y[i] += depth * normals.y[i];
        points.z[i] += depth * normals.z[i];
        moved = true;
      }
    }
  }
}

void pushRowsOut(const GridLayout& g, const DistanceField& field, double fat_m, VectorArray& r) {
  std::vector<Box> boxes;
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    boxes.push_back(field.bounds(SolidId(static_cast<std::int64_t>(s))));
  const auto columns = static_cast<std::size_t>(g.columns);
  parallelFor(static_cast<std::size_t>(g.rows - 2), [&](std::size_t row) {
    for (std::size_t i = 0; i < columns; i += kPushedTogether)
      pushOut(
          field, boxes, static_cast<float>(fat_m),
          view(r, g.row(static_cast<int>(row) + 1) + i, std::min(kPushedTogether, columns - i)));
  });
}

void addFat(const GridLayout& g, double change_m, VectorArray& r) {
  VectorArray normal(g.storage());
  gridNormals(g, r, 0, g.rows, normal);
  const auto change = static_cast<float>(change_m);
  forEachStored(g, 1, g.rows - 1, [&](std::size_t k) {
    for (const auto axis : VectorArray::kAxes) (r.*axis)[k] += change * (normal.*axis)[k];
  });
  fillPads(g, r);
}

bool sameStructure(const SolidDef& a, const SolidDef& b) {
  return a.shape == b.shape && std::ranges::equal(a.deformations, b.deformations, {},
                                                  &SolidDef::Step::type, &SolidDef::Step::type);
}

}  // namespace

GridWrapKey GridWrapKey::of(const SkinDef& def, JointId bottom, JointId top) {
  GridWrapKey key{};
  key.columns = def.grid.columns, key.rows = def.grid.rows;
  key.bottom = def.grid.bottom, key.top = def.grid.top;
  key.bottom.joint.clear(), key.top.joint.clear();
  key.endJoints[0] = bottom, key.endJoints[1] = top;
  key.cling = def.grid.cling;
  if (!def.points || (def.points->rest_position_m.empty() && def.points->anchor.empty()))
    return key;
  key.savedColumns = def.points->columns, key.savedRows = def.points->rows;
  key.savedRest = def.points->rest_position_m;
  key.savedAnchor = def.points->anchor;
  key.savedAnchorSolid = def.points->anchor_solid;
  return key;
}

bool sameStructure(const Flesh& a, const Flesh& b) {
  if (a.solidCount() != b.solidCount()) return false;
  for (std::size_t s = 0; s < a.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    const FleshSolidDef &before = a.def(id), &now = b.def(id);
    if (!sameStructure(before.solid, now.solid)) return false;
    // A name that goes on elsewhere: solids were exchanged, not renamed.
    if (before.name != now.name && (a.find(now.name).valid() || b.find(before.name).valid()))
      return false;
  }
  return true;
}

FollowedGrid followMatter(const GridWrap& wrap, const Flesh& flesh) {
  return {wrap.rest, mapped(wrap.anchors, wrap.flesh, flesh),
          mapped(wrap.placements, wrap.flesh, flesh)};
}

void placeIn(const PosedFlesh& flesh, FollowedGrid& grid) {
  parallelFor(grid.placements.size(), [&](std::size_t n) {
    TissueAnchors::Anchor& p = grid.placements[n];
    p.material = flesh.materialFromWorld(p.solid, pointAt(grid.rest, p.point));
  });
}

FollowedGrid follow(const GridWrap& wrap, const FollowInput& input) {
  const GridLayout& g = wrap.layout;
  FollowedGrid out = followMatter(wrap, input.flesh);
  VectorArray way = isAsWrapped(wrap, input) ? VectorArray(wrap.rest.size())
                                             : waysOfMatter(wrap, input, out.placements);
  const bool matterMoves = anyWay(way);
  setEndWays(wrap, input, way);
  const double fatChange_m = input.fat_m - wrap.fat_m;
  if (!anyWay(way) && fatChange_m == 0) return out;
  fillPads(g, way);
  for (const auto axis : VectorArray::kAxes) {
    if (matterMoves) evenOut(g, way.*axis);
    for (std::size_t k = 0; k < out.rest.size(); ++k) (out.rest.*axis)[k] += (way.*axis)[k];
  }
  fillPads(g, out.rest);
  if (fatChange_m != 0) addFat(g, fatChange_m, out.rest);
  pushRowsOut(g, input.posedFlesh, input.fat_m, out.rest);
  fillPads(g, out.rest);
  placeIn(input.posedFlesh, out);
  return out;
}

}  // namespace fascia
