#include <fascia/skin/mesh_skin_builder.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>

// What an imported skin is made of, point by point: the fat beneath it, and what follows from that.

namespace fascia {
namespace {

// A point farther from all flesh than this share of the model's size has none beneath it.
constexpr double kBare = 0.03;
// Nor has one whose normal turns farther than acos of this from the flesh's: the inside of a mouth,
// the sides of fingers that share a joint.
constexpr double kFacing = 0.25;
// How much firmer, and how much softer, the tissue is where the fat is thin or thick.
constexpr double kFirmest = 6, kSoftest = 0.7;
constexpr double kLightest = 0.3, kHeaviest = 1.5;
// Tissue is firm enough that a point's weight stretches its strand by no more than this share of
// the edges around it: fingers are modelled finely, and would crumple if they hung like a belly.
constexpr double kMostSag = 0.25;

double medianOf(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<Vec3> MeshSkinBuilder::pointNormals() const {
  std::vector<Eigen::Vector3f> normals;
  computeNormals(rig_.points_m, rig_.triangles, normals);
  std::vector<Vec3> out;
  out.reserve(normals.size());
  for (const Eigen::Vector3f& n : normals) out.push_back(n.cast<double>());
  return out;
}

Vec3 MeshSkinBuilder::modelPoint(std::size_t p) const {
  return rig_.points_m[p].cast<double>();
}

// The fat of an imported figure is what lies between its surface and its solids.
void MeshSkinBuilder::measureFat() {
  const std::size_t count = rig_.points_m.size();
  making_->gap_m.resize(count);
  making_->solid.resize(count);
  making_->covered.resize(count);
  const double bare = kBare * rig_.size_m();
  const std::vector<Vec3>& normals = making_->normals;
  std::vector<double> facing(count);
  parallelFor(count, [&](std::size_t p) {
    const NearestFlesh nearest = nearestFlesh(base_.posedFlesh, modelPoint(p), felt_[p]);
    making_->gap_m[p] = nearest.distance;
    making_->solid[p] = nearest.solid;
    facing[p] = nearest.distance < bare ? nearest.normal.dot(normals[p]) : 0;
  });
  // Some pieces are modelled inside out.
  std::vector<double> outward(rig_.componentCount);
  for (std::size_t p = 0; p < count; ++p) outward[rig_.component[p]] += facing[p];
  for (std::size_t p = 0; p < count; ++p)
    making_->covered[p] = std::copysign(1.0, outward[rig_.component[p]]) * facing[p] > kFacing;
}

// Uniform values; where the fat is thin the skin is lighter and sits tighter, where it is thick it
// weighs and gives more. Then what the file says of single points, regions and brushes.
void MeshSkinBuilder::setQuantities() {
  const std::size_t storage = shape_->rest.size();
  std::vector<float> thicknesses;
  for (std::size_t p = 0; p < rest_->gap_m.size(); ++p)
    if (rest_->covered[p] && !rest_->fixed[p])
      thicknesses.push_back(std::max(rest_->gap_m[p], 0.f));
  const double usual = std::max(medianOf(std::move(thicknesses)), 1e-4 * shape_->size_m);

  const std::vector<double>& edges = rest_->edges_m;
  const double gravity = settings_.gravity_m_per_s2.norm();
  SkinQuantities& q = (*quantities_);
  for (const QuantityInfo& i : quantityInfos())
    q[i.quantity].assign(storage, static_cast<float>(uniformValue(def_, i.quantity)));
  for (std::size_t k = 0; k < rest_->order.size(); ++k) {
    const std::uint32_t p = rest_->order[k];
    const double thickness =
        rest_->covered[p] ? std::clamp<double>(rest_->gap_m[p], 1e-9, def_.fat.thickness_m) : 1e-9;
    const double thin = usual / thickness;
    q[SkinQuantity::fat][k] = rest_->covered[p] ? static_cast<float>(thickness) : 0.f;
    q[SkinQuantity::tissue_stiffness][k] *=
        static_cast<float>(std::clamp(thin, kSoftest, kFirmest));
    q[SkinQuantity::density][k] *= static_cast<float>(std::clamp(1 / thin, kLightest, kHeaviest));
    if (edges[p] > 0)
      q[SkinQuantity::tissue_stiffness][k] =
          std::max(q[SkinQuantity::tissue_stiffness][k],
                   static_cast<float>(double{q[SkinQuantity::density][k]} * gravity /
                                      (kMostSag * edges[p])));
    q[SkinQuantity::tissue_rest_length][k] =
        static_cast<float>(def_.tissue.rest_length_m.value_or(0));
  }
  naturalFat_ = q[SkinQuantity::fat];
  if (def_.points)
    for (const QuantityInfo& i : quantityInfos()) {
      const std::vector<float>& saved = pointValues(*def_.points, i.quantity);
      if (saved.empty()) continue;
      for (std::size_t k = 0; k < rest_->order.size(); ++k)
        q[i.quantity][k] = saved[rest_->order[k]];
    }
  std::vector<EditPoint> points;
  for (std::size_t k = 0; k < rest_->order.size(); ++k)
    points.push_back({k, 0, 0,
                      rest_->covered[rest_->order[k]] ? rest_->solid[rest_->order[k]] : SolidId(),
                      &rig_.weights[rest_->order[k]]});
  QuantityMask all;
  all.fill(true);
  std::vector<std::string> joints;
  for (std::size_t j = 0; j < rig_.joints.size(); ++j) joints.push_back(nameOf(j));
  applySkinEdits(def_, base_, report_, points, {SkinKind::rig, joints}, shape_->rest, all, q);
}

}  // namespace fascia
