#include <fascia/skin/grid/wrap.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/grid/flesh_path.h>
#include <fascia/skin/grid/resample.h>
#include <fascia/skin/point/nearest_solids.h>

namespace fascia {
namespace {

// Weights of the discrete Laplacian along and around the tube. The tension along is larger so that
// rows spread evenly from end to end; equal tensions would crowd them at the narrow ends, as a soap
// film does.
constexpr double kAlong = 0.8, kAround = 0.2;
constexpr int kCoarsest = 16;  // rows of the level that starts from the sphere
constexpr int kFirstIterations = 600, kIterations = 120;
constexpr std::size_t kBlocksOfTask = 8;  // fewer cost more to hand out than to do
constexpr double kReachOfField = 0.01;    // see NearestSolids

Vec3 towardsFront(const Vec3& upAxis) {
  // The front is +z; a tube lying along z has its front on top.
  const Vec3 forward = std::abs(upAxis.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitY();
  return (forward - forward.dot(upAxis) * upAxis).normalized();
}

// Rows of a grid in pieces that lie together, each with what it knows of the solids near it.
struct WrapBlock {
  std::size_t first, count;  // storage indices
  NearestSolids flesh;
};

Box boundsOf(const DistanceField& field) {
  Box box;
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    box.add(field.bounds(SolidId(std::int64_t(s))));
  return box;
}

// Of the rows between the ends.
std::vector<WrapBlock> blocksOf(const DistanceField& field, const GridLayout& g) {
  const double reach_m = kReachOfField * boundsOf(field).size().norm();
  std::vector<WrapBlock> blocks;
  const auto columns = static_cast<std::size_t>(g.columns);
  for (int j = 1; j + 1 < g.rows; ++j)
    for (std::size_t i = 0; i < columns; i += NearestSolids::kBlock)
      blocks.push_back({g.row(j) + i, std::min(NearestSolids::kBlock, columns - i),
                        NearestSolids(field, reach_m)});
  return blocks;
}

// Each point moves towards the mean of its neighbours.
void tighten(const GridLayout& g, const WrapBlock& block, const VectorArray& from,
             VectorArray& to) {
  for (const auto axis : VectorArray::kAxes) {
    const float* here = (from.*axis).data() + block.first;
    const float *below = here - g.stride(), *above = here + g.stride();
    const float *before = here - 1, *after = here + 1;
    float* out = (to.*axis).data() + block.first;
    for (std::size_t i = 0; i < block.count; ++i)
      out[i] = static_cast<float>(0.5 * kAlong * (below[i] + above[i]) +
                                  0.5 * kAround * (before[i] + after[i]));
  }
}

// Out of the flesh to the distance of the fat; from outside by the share `cling` of the way there.
// Returns whether any point was inside.
bool rest(double fat_m, double cling, WrapBlock& block, VectorArray& r) {
  block.flesh.measure(view(static_cast<const VectorArray&>(r), block.first, block.count));
  const ConstVectors normals = block.flesh.normals();
  const Vectors out = view(r, block.first, block.count);
  for (std::size_t i = 0; i < block.count; ++i) {
    const double gap = block.flesh.distance_m(i) - fat_m;
    const double move = (gap < 0 ? -1 : -cling) * gap;
    out.x[i] += static_cast<float>(move * normals.x[i]);
    out.y[i] += static_cast<float>(move * normals.y[i]);
    out.z[i] += static_cast<float>(move * normals.z[i]);
  }
  return block.flesh.anyNearer(fat_m);
}

// Jacobi sweeps: towards the neighbours, towards the flesh, out of it.
void relax(const GridLayout& g, const WrapOptions& options, double cling, int iterations,
           std::vector<WrapBlock>& blocks, VectorArray& r) {
  VectorArray next = r;
  const std::size_t tasks = (blocks.size() + kBlocksOfTask - 1) / kBlocksOfTask;
  const auto sweep = [&](std::size_t task) {
    const std::size_t end = std::min(blocks.size(), (task + 1) * kBlocksOfTask);
    for (std::size_t b = task * kBlocksOfTask; b < end; ++b) {
      tighten(g, blocks[b], r, next);
      // Leaving one solid may enter its neighbour.
      if (rest(options.fat_m, cling, blocks[b], next)) rest(options.fat_m, 0, blocks[b], next);
    }
  };
  for (int n = 0; n < iterations; ++n) {
    parallelFor(tasks, sweep);
    fillPads(g, next);
    std::swap(r, next);
  }
}

// A tube between two rings, and which way it leads at each of them.
struct Tube {
  const EndRing &bottom, &top;
  Vec3 upAtBottom, upAtTop;
};

void setEnds(const GridLayout& g, const Tube& tube, VectorArray& r) {
  for (int i = 0; i < g.columns; ++i) {
    const double u = static_cast<double>(i) / g.columns;
    setPoint(r, g.at(i, 0), ringPoint(tube.bottom, tube.upAtBottom, u));
    setPoint(r, g.at(i, g.rows - 1), ringPoint(tube.top, tube.upAtTop, u));
  }
  fillPads(g, r);
}

// The share of the gap to the flesh that a point closes per sweep. Tension pulls with the square of
// the points' spacing, so clinging has to weaken alike, or finer skins would follow hollows more.
double clingRate(const GridLayout& g, const WrapOptions& options) {
  constexpr double kReferencePoints = 1024;
  return 0.5 * options.cling *
         std::min(1.0, kReferencePoints / static_cast<double>(g.pointCount()));
}

VectorArray sphereAround(const DistanceField& field, const GridLayout& g, const Vec3& upAxis) {
  const Box box = boundsOf(field);
  const double radius = 0.55 * box.size().norm();
  const Vec3 front = towardsFront(upAxis), side = upAxis.cross(front);
  VectorArray r(g.storage());
  for (int j = 0; j < g.rows; ++j) {
    const double latitude = kPi * j / (g.rows - 1);
    for (int i = 0; i < g.columns; ++i) {
      const double a = 2 * kPi * i / g.columns;
      const Vec3 around = -std::cos(a) * front - std::sin(a) * side;
      setPoint(r, g.at(i, j),
               box.center() + radius * (std::sin(latitude) * around - std::cos(latitude) * upAxis));
    }
  }
  return r;
}

// Where a ray from inside of the flesh has left it by fat_m for the first time, at most reach_m
// away.
double wayOut(const DistanceField& field, const Vec3& origin, const Vec3& way, double fat_m,
              double reach_m) {
  NearestSolids flesh(field, kReachOfField * reach_m);
  VectorArray at(NearestSolids::kBlock);
  constexpr std::size_t kBlock = NearestSolids::kBlock, kSamples = 8 * kBlock;
  const double step = reach_m / static_cast<double>(kSamples);
  for (std::size_t first = 0; first < kSamples; first += kBlock) {
    for (std::size_t i = 0; i < kBlock; ++i)
      setPoint(at, i, origin + static_cast<double>(first + i) * step * way);
    flesh.measure(view(static_cast<const VectorArray&>(at), 0, kBlock));
    for (std::size_t i = 0; i < kBlock; ++i)
      if (double{flesh.distance_m(i)} >= fat_m) return static_cast<double>(first + i) * step;
  }
  return reach_m;
}

// Rows of a tube around a path: places, and which way is front and which way is along.
struct PathFrame {
  Vec3 place, along, front;
};

// Turned as little as possible from one to the next, and evenly from the front of the one end to
// that of the other.
std::vector<PathFrame> framesAlong(const std::vector<Vec3>& path, const Tube& tube) {
  const auto frontAt = [](const EndRing& ring, const Vec3& along) {
    return towardsFront(ring.axis.dot(along) < 0 ? Vec3(-ring.axis) : ring.axis);
  };
  const auto across = [](const Vec3& way, const Vec3& along) {
    return Vec3((way - way.dot(along) * along).normalized());
  };
  std::vector<PathFrame> frames;
  Vec3 front = frontAt(tube.bottom, tube.upAtBottom);
  for (std::size_t j = 0; j < path.size(); ++j) {
    const Vec3 way = path[std::min(j + 1, path.size() - 1)] - path[j == 0 ? 0 : j - 1];
    const Vec3 along = way.norm() > 1e-12 ? Vec3(way.normalized()) : tube.upAtBottom;
    front = across(front, along);
    frames.push_back({path[j], along, front});
  }
  const Vec3 last = across(frontAt(tube.top, tube.upAtTop), frames.back().along);
  const double twist = std::atan2(frames.back().along.dot(front.cross(last)), front.dot(last));
  for (std::size_t j = 0; j < frames.size(); ++j) {
    const double share = static_cast<double>(j) / static_cast<double>(frames.size() - 1);
    frames[j].front = Eigen::AngleAxisd(share * twist, frames[j].along) * frames[j].front;
  }
  return frames;
}

// Each row around its place on the path, where the flesh around that ends; not so far that it would
// be nearer to the path somewhere else, where rows of a bend would pass each other.
VectorArray tubeAlong(const DistanceField& field, const GridLayout& g, const Tube& tube,
                      const std::vector<Vec3>& path, double fat_m) {
  constexpr double kOwn = 0.85;  // a place whose path is nearer than this share is another row's
  const std::vector<PathFrame> frames = framesAlong(path, tube);
  const double reach_m = 0.5 * boundsOf(field).size().norm();
  VectorArray r(g.storage());
  parallelFor(static_cast<std::size_t>(g.rows), [&](std::size_t j) {
    const PathFrame& f = frames[j];
    const Vec3 side = f.along.cross(f.front);
    for (int i = 0; i < g.columns; ++i) {
      const double a = 2 * kPi * i / g.columns;
      const Vec3 way = -std::cos(a) * f.front - std::sin(a) * side;
      double far = std::max(fat_m, wayOut(field, f.place, way, fat_m, reach_m));
      const auto isOwn = [&](double distance) {
        const Vec3 p = f.place + distance * way;
        return std::ranges::none_of(
            path, [&](const Vec3& other) { return (other - p).norm() < kOwn * distance; });
      };
      while (far > fat_m && !isOwn(far)) far *= 0.9;
      setPoint(r, g.at(i, static_cast<int>(j)), f.place + far * way);
    }
  });
  fillPads(g, r);
  return r;
}

// From a start around the flesh at the coarsest level to where it rests on it at the finest.
template <class Start>
VectorArray contract(const DistanceField& field, const GridLayout& layout, const Tube& tube,
                     const WrapOptions& options, int firstIterations, const Start& start) {
  std::vector<GridLayout> levels{layout};
  while (levels.back().rows > 2 * kCoarsest && levels.back().columns > 2 * kCoarsest) {
    GridLayout coarser = levels.back();
    coarser.rows = (coarser.rows + 1) / 2;
    coarser.columns = (coarser.columns + 1) / 2;
    levels.push_back(coarser);
  }
  VectorArray r = start(levels.back());
  for (std::size_t n = levels.size(); n-- > 0;) {
    const bool coarsest = n + 1 == levels.size();
    if (!coarsest) r = resample(levels[n + 1], r, levels[n]);
    setEnds(levels[n], tube, r);
    // Shrink first, cling then: clinging from afar would pull rows to whatever is nearest.
    std::vector<WrapBlock> blocks = blocksOf(field, levels[n]);
    if (coarsest) relax(levels[n], options, 0, firstIterations, blocks, r);
    relax(levels[n], options, clingRate(levels[n], options), kIterations, blocks, r);
  }
  return r;
}

}  // namespace

Vec3 ringPoint(const EndRing& ring, const Vec3& upAxis, double u) {
  // The ring lies across its own axis, turned as little as possible from the tube's.
  const Vec3 up = ring.axis.dot(upAxis) < 0 ? Vec3(-ring.axis) : ring.axis;
  const Vec3 front = towardsFront(up), side = up.cross(front);
  const double a = 2 * kPi * u;
  return ring.center_m + ring.radius_m * (-std::cos(a) * front - std::sin(a) * side);
}

Vec3 exitPoint(const DistanceField& field, const Vec3& origin, const Vec3& axis,
               double clearance_m) {
  Box box = boundsOf(field);
  box.add(origin);
  const double reach = box.size().norm();
  NearestSolids flesh(field, kReachOfField * reach);
  VectorArray at(NearestSolids::kBlock);
  // How far apart the samples i, i + 1, … of the ray are from the flesh.
  const auto measure = [&](double t, double step, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      setPoint(at, i, origin + (t + static_cast<double>(i) * step) * axis);
    flesh.measure(view(static_cast<const VectorArray&>(at), 0, count));
  };
  // March inwards from outside of everything until the clearance is used up, then bisect.
  constexpr int kSamples = 2048, kBlock = NearestSolids::kBlock;
  const double step = reach / kSamples;
  double low = 0, high = reach;
  for (int first = kSamples - kBlock; first >= 0 && low == 0; first -= kBlock) {
    measure(first * step, step, NearestSolids::kBlock);
    for (int i = kBlock - 1; i >= 0 && low == 0; --i) {
      if (flesh.distance_m(static_cast<std::size_t>(i)) < clearance_m)
        low = (first + i) * step;
      else
        high = (first + i) * step;
    }
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    measure(middle, 0, 1);
    (flesh.distance_m(0) < clearance_m ? low : high) = middle;
  }
  return origin + high * axis;
}

VectorArray shrinkWrap(const DistanceField& field, const GridLayout& layout, const EndRing& bottom,
                       const EndRing& top, const WrapOptions& options) {
  Vec3 upAxis = top.center_m - bottom.center_m;
  upAxis = upAxis.norm() > 1e-9 ? Vec3(upAxis.normalized()) : Vec3(Vec3::UnitY());
  return contract(
      field, layout, {bottom, top, upAxis, upAxis}, options, kFirstIterations,
      [&](const GridLayout& coarsest) { return sphereAround(field, coarsest, upAxis); });
}

VectorArray wrapAlongFlesh(const DistanceField& field, const GridLayout& layout,
                           const EndRing& bottom, const EndRing& top, const WrapOptions& options) {
  const std::vector<Vec3> path =
      pathThroughFlesh(field, bottom.center_m, top.center_m, static_cast<std::size_t>(layout.rows));
  const auto towards = [](const Vec3& from, const Vec3& to) {
    return (to - from).norm() > 1e-9 ? Vec3((to - from).normalized()) : Vec3(Vec3::UnitY());
  };
  const Tube tube{bottom, top, towards(path[0], path[1]),
                  towards(path[path.size() - 2], path.back())};
  return contract(field, layout, tube, options, kIterations, [&](const GridLayout& coarsest) {
    return tubeAlong(field, coarsest, tube,
                     pathThroughFlesh(field, bottom.center_m, top.center_m,
                                      static_cast<std::size_t>(coarsest.rows)),
                     options.fat_m);
  });
}

}  // namespace fascia
