#include <algorithm>
#include <array>
#include <utility>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/contact/face_lift.h>
#include <fascia/skin/grid/grid_kernels.h>
#include <fascia/skin/grid/resample.h>
#include <fascia/skin/grid/tube_mesh.h>
#include <fascia/skin/grid_skin_builder.h>
#include <fascia/skin/point/attach.h>
#include <fascia/skin/point/face_samples.h>
#include <fascia/skin/point/nearest_solids.h>
#include <fascia/skin/skin_fit.h>

// How a grid is laid around the flesh.
namespace fascia {
namespace {

// Radius of an end ring that the file leaves open, over the distance of the ends. The same at every
// resolution: a membrane held at a mere point would stretch without bound there.
constexpr double kEndRadius = 0.022;
// How deep a face may cut the flesh between its samples, as a share of the skin's size.
constexpr double kFaceTolerance = 1e-3;

// Rows in pieces that lie together.
std::vector<PointRun> runsOf(const GridLayout& g) {
  std::vector<PointRun> runs;
  const auto columns = static_cast<std::size_t>(g.columns);
  for (int j = 0; j < g.rows; ++j)
    for (std::size_t i = 0; i < columns; i += NearestSolids::kBlock)
      runs.push_back({g.row(j) + i, static_cast<std::size_t>(j) * columns + i,
                      std::min(NearestSolids::kBlock, columns - i)});
  return runs;
}

}  // namespace

bool GridSkinBuilder::findEnds(EndRing (&rings)[2]) const {
  const SkinEndDef* ends[2] = {&def_.grid.bottom, &def_.grid.top};
  Vec3 origin[2];
  for (int e = 0; e < 2; ++e) origin[e] = jointFrame(e).point(ends[e]->position_m);
  for (int e = 0; e < 2; ++e) {
    Vec3 axis = ends[e]->axis.norm() > 0 ? jointFrame(e).vector(ends[e]->axis)
                                         : Vec3(origin[e] - origin[1 - e]);
    if (!(axis.norm() > 1e-9)) axis = e == 0 ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitY());
    rings[e].axis = axis.normalized();
    rings[e].center_m = exitPoint(base_.posedFlesh, origin[e], rings[e].axis, def_.fat.thickness_m);
  }
  const double length = (rings[1].center_m - rings[0].center_m).norm();
  for (int e = 0; e < 2; ++e) {
    rings[e].radius_m = ends[e]->radius_m > 0 ? ends[e]->radius_m : kEndRadius * length;
    if (rings[e].radius_m > 1e-6) continue;
    report_.error(e == 0 ? "/bottom" : "/top", "found both ends of the skin in the same place",
                  "fix the ends to different joints, or give them different axes");
    return false;
  }
  return true;
}

std::shared_ptr<const GridWrap> GridSkinBuilder::wrapAnew(const GridWrapKey& key,
                                                          const EndRing (&ends)[2]) const {
  auto wrap = std::make_shared<GridWrap>();
  wrap->key = key;
  wrap->layout = layout_;
  wrap->fat_m = def_.fat.thickness_m;
  std::copy(ends, ends + 2, wrap->ends);
  wrap->flesh = base_.flesh;
  wrap->posedFlesh = base_.posedFlesh;
  if (isSaved())
    wrap->rest = savedShape(), wrap->fit = fitOf(wrap->rest);
  else
    wrapFlesh(ends, *wrap);
  FaceSamples faces = sampleFaces(wrap->posedFlesh, cellTriangles(layout_), wrap->rest, wrap->fat_m,
                                  kFaceTolerance * sizeOf(wrap->rest));
  if (!faces.empty()) {
    if (!isSaved()) liftRest(faces, *wrap);
    measureEdges(wrap->rest, faces);
    wrap->faces = std::make_shared<FaceSamples>(std::move(faces));
  }
  placePoints(*wrap);
  attach(*wrap);
  return wrap;
}

// Faces that are lifted whenever they are shown are no longer then than at rest.
void GridSkinBuilder::liftRest(const FaceSamples& faces, GridWrap& wrap) const {
  PointModel points;
  points.fat.assign(layout_.storage(), static_cast<float>(wrap.fat_m));
  points.free.assign(layout_.storage(), 0.f);
  forEachGridPoint(layout_, [&](int, int j, std::size_t k) {
    if (j > 0 && j + 1 < layout_.rows) points.free[k] = 1;
  });
  liftFaces(faces, wrap.posedFlesh, points, static_cast<float>(kFaceClearance * sizeOf(wrap.rest)),
            kRestLift, wrap.rest);
  fillPads(layout_, wrap.rest);
}

bool GridSkinBuilder::isSaved() const {
  return def_.points && !def_.points->rest_position_m.empty();
}

// A straight tube, or one along the way through the flesh where that holds more of it.
void GridSkinBuilder::wrapFlesh(const EndRing (&ends)[2], GridWrap& wrap) const {
  const WrapOptions options{def_.fat.thickness_m, def_.grid.cling};
  const auto faults = [](const SkinFit& fit) {
    return std::pair(fit.outside.size(), fit.crossings);
  };
  wrap.rest = shrinkWrap(base_.posedFlesh, layout_, ends[0], ends[1], options);
  wrap.fit = fitOf(wrap.rest);
  if (faults(*wrap.fit) == std::pair<std::size_t, std::size_t>(0, 0)) return;
  VectorArray along = wrapAlongFlesh(base_.posedFlesh, layout_, ends[0], ends[1], options);
  std::shared_ptr<const SkinFit> fit = fitOf(along);
  if (!(faults(*fit) < faults(*wrap.fit))) return;
  wrap.rest = std::move(along);
  wrap.fit = std::move(fit);
}

std::shared_ptr<const SkinFit> GridSkinBuilder::fitOf(const VectorArray& tube) const {
  return std::make_shared<SkinFit>(findSkinFit(base_.posedFlesh, closedTube(layout_, tube)));
}

VectorArray GridSkinBuilder::savedShape() const {
  const GridLayout saved = savedLayout();
  VectorArray r(saved.storage());
  std::size_t p = 0;
  forEachGridPoint(saved, [&](int, int, std::size_t k) {
    const auto& v = def_.points->rest_position_m[p++];
    r.x[k] = v[0], r.y[k] = v[1], r.z[k] = v[2];
  });
  fillPads(saved, r);
  return sameGrid() ? r : resample(saved, r, layout_);
}

void GridSkinBuilder::placePoints(GridWrap& wrap) const {
  const std::vector<SolidId> solids = nearestSolids(wrap.posedFlesh, runsOf(layout_), wrap.rest);
  wrap.placements.resize(solids.size());
  const auto columns = static_cast<std::size_t>(layout_.columns);
  parallelFor(solids.size() / columns, [&](std::size_t row) {
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t p = row * columns + i, k = layout_.row(static_cast<int>(row)) + i;
      const Vec3 material = wrap.posedFlesh.materialFromWorld(solids[p], pointAt(wrap.rest, k));
      wrap.placements[p] = {k, solids[p], material};
    }
  });
  wrap.placed = VectorArray(layout_.storage());
  VectorArray scratch;
  TissueAnchors(wrap.placements).place(wrap.posedFlesh, scratch, wrap.placed);
}

// The strands of all inner points, row by row.
void GridSkinBuilder::attach(GridWrap& wrap) const {
  const bool saved = def_.points && !def_.points->anchor.empty() && sameGrid();
  std::vector<Attachment> found;
  if (!saved) {
    VectorArray normals(layout_.storage());
    gridNormals(layout_, wrap.rest, 0, layout_.rows, normals);
    found = attachAlongNormals(wrap.posedFlesh, runsOf(layout_), wrap.rest, normals, wrap.fat_m);
  }
  const auto columns = static_cast<std::size_t>(layout_.columns);
  const auto inner = static_cast<std::size_t>(layout_.rows - 2);
  wrap.anchors.resize(columns * inner);
  parallelFor(inner, [&](std::size_t row) {
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t p = (row + 1) * columns + i;
      TissueAnchors::Anchor& anchor = wrap.anchors[row * columns + i];
      anchor.point = layout_.row(static_cast<int>(row) + 1) + i;
      if (saved) {
        anchor.solid = SolidId(def_.points->anchor_solid[p]);
        const auto& m = def_.points->anchor[p];
        anchor.material = Vec3(m[0], m[1], m[2]);
      } else {
        anchor.solid = found[p].solid;
        anchor.material = wrap.posedFlesh.materialFromWorld(anchor.solid, found[p].place_m);
      }
    }
  });
}

double GridSkinBuilder::sizeOf(const VectorArray& rest) const {
  Box box;
  forEachGridPoint(layout_, [&](int, int, std::size_t k) { box.add(pointAt(rest, k)); });
  return std::max(1e-6, box.size().norm());
}

}  // namespace fascia
