#include <fascia/world/skin_obstacle.h>

#include <algorithm>

namespace fascia {
namespace {

// Bounds of how far a skin gives way: where a solid shows through, m, and where there is none
// below, as in ears, of the skin's size.
constexpr float kLeastDepth_m = 2e-3f;
constexpr double kMostDepth = 0.05;

}  // namespace

SkinObstacle::SkinObstacle(const SceneCharacterDef& def, CharacterState& state)
    : character_(*def.character),
      place_(placeOf(def)),
      placer_(character_.skin()->attachment().makePlacer()) {
  place(state, to_);
  from_ = now_ = to_;
  const std::vector<float> depth_m = depths(state);
  TriangleMesh mesh;
  mesh.positions = to_;
  mesh.triangles = mesh_.triangles;
  field_ = std::make_unique<SurfaceField>(mesh, depth_m);
}

void SkinObstacle::place(const CharacterState& state, std::vector<Eigen::Vector3f>& points) {
  const Skin& skin = *character_.skin();
  skin_.resize(skin.topology().storage());
  placer_->placeAll({&state.flesh, state.skeleton.joint_world}, skin_);
  skin.topology().surface(skin_, mesh_);
  points.resize(mesh_.positions.size());
  for (std::size_t v = 0; v < points.size(); ++v)
    points[v] = place_.point(mesh_.positions[v].cast<double>()).cast<float>();
}

// From each vertex to the nearest of the flesh's solids.
std::vector<float> SkinObstacle::depths(const CharacterState& state) const {
  const std::size_t count = mesh_.positions.size();
  VectorArray points(count), normal(count);
  for (std::size_t v = 0; v < count; ++v)
    for (int axis = 0; axis < 3; ++axis)
      (points.*VectorArray::kAxes[axis])[v] = mesh_.positions[v][axis];
  FloatArray distance_m(count);
  const auto most_m = static_cast<float>(kMostDepth * character_.skin()->size_m());
  std::vector<float> depth_m(count, most_m);
  for (std::size_t s = 0; s < state.flesh.solidCount(); ++s) {
    state.flesh.evaluate(SolidId(s), view(points, 0, count), distance_m.data(),
                         view(normal, 0, count));
    for (std::size_t v = 0; v < count; ++v) depth_m[v] = std::min(depth_m[v], distance_m[v]);
  }
  for (float& depth : depth_m) depth = std::max(depth, kLeastDepth_m);
  return depth_m;
}

void SkinObstacle::setFrame(double start_s, double end_s, CharacterState& state) {
  start_s_ = start_s, end_s_ = end_s;
  std::swap(from_, to_);
  place(state, to_);
}

void SkinObstacle::moveTo(double time_s) {
  const double span_s = end_s_ - start_s_;
  const auto u = static_cast<float>((time_s - start_s_) / span_s);
  for (std::size_t v = 0; v < now_.size(); ++v) now_[v] = from_[v] + u * (to_[v] - from_[v]);
  field_->update(now_, from_, std::max(time_s - start_s_, 1e-9));
}

}  // namespace fascia
