#include <fascia/io/glb_export/grid_rig.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fascia/io/glb_export/gltf_character_nodes.h>

namespace fascia {
namespace {

// Of the skin's size: joints whose solids are farther away than the nearest one's by this do not
// carry a point. Wider offers the fit more joints, and costs it time.
constexpr double kReach = 0.08;
constexpr std::size_t kMostGuessed = 4;

void weld(GridRig& rig) {
  std::map<std::array<float, 3>, std::uint32_t> known;
  for (const Eigen::Vector3f& p : rig.surface.positions) {
    const auto next = static_cast<std::uint32_t>(rig.points_m.size());
    const auto [found, isNew] = known.try_emplace({p.x(), p.y(), p.z()}, next);
    if (isNew) rig.points_m.push_back(p);
    rig.pointOf.push_back(found->second);
  }
  for (const auto& [a, b, c] : rig.surface.triangles) {
    const std::array<std::uint32_t, 3> t{rig.pointOf[a], rig.pointOf[b], rig.pointOf[c]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) rig.triangles.push_back(t);
  }
  std::vector<Eigen::Vector3f> normals;
  computeNormals(rig.points_m, rig.triangles, normals);
  rig.surface.normals.clear();
  for (const std::uint32_t p : rig.pointOf) rig.surface.normals.push_back(normals[p]);
}

// Of every point to the nearest solid of each joint; large where a joint has none.
std::vector<std::vector<float>> distances(const Character& character, const CharacterState& state,
                                          const std::vector<Eigen::Vector3f>& points) {
  VectorArray at(points.size()), normal(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    at.x[i] = points[i].x(), at.y[i] = points[i].y(), at.z[i] = points[i].z();
  }
  std::vector<std::vector<float>> out(character.skeleton().jointCount(),
                                      std::vector<float>(points.size(), 1e30f));
  std::vector<float> found(points.size());
  for (std::size_t s = 0; s < character.flesh().solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    state.flesh.evaluate(id, view(at, 0, points.size()), found.data(),
                         view(normal, 0, points.size()));
    std::vector<float>& least = out[character.flesh().joint(id).index()];
    for (std::size_t i = 0; i < points.size(); ++i) least[i] = std::min(least[i], found[i]);
  }
  return out;
}

PointWeights guess(const std::vector<std::vector<float>>& distance_m, std::size_t point,
                   double reach_m) {
  std::vector<std::pair<double, std::size_t>> order;  // distance, joint
  for (std::size_t j = 0; j < distance_m.size(); ++j)
    order.emplace_back(static_cast<double>(distance_m[j][point]), j);
  std::sort(order.begin(), order.end());
  const double nearest_m = order.front().first;
  std::array<double, kMostGuessed> share{};
  double sum = 0;
  for (std::size_t k = 0; k < std::min(kMostGuessed, order.size()); ++k) {
    share[k] = std::pow(std::max(0.0, 1 - (order[k].first - nearest_m) / reach_m), 2);
    sum += share[k];
  }
  PointWeights out;
  for (std::size_t k = 0; k < kMostGuessed && share[k] > 0; ++k) {
    out.joint[k] = static_cast<std::uint16_t>(order[k].second);
    out.weight[k] = static_cast<float>(share[k] / sum);
  }
  return out;
}

void check(const GridRig& rig, const Recording& recording) {
  if (recording.frames.empty()) throw Error("a recording without frames cannot be exported");
  for (std::size_t f = 0; f < recording.frames.size(); ++f) {
    const Recording::Frame& frame = recording.frames[f];
    if (frame.skin_m.size() != rig.pointOf.size())
      throw Error("the recording is of another character");
    if (!std::isfinite(frame.time_s) || (f > 0 && !(frame.time_s > recording.frames[f - 1].time_s)))
      throw Error("the frames of the recording are not in order");
    for (const Eigen::Vector3f& p : frame.skin_m) {
      if (!p.allFinite()) throw Error("the recording holds a position that is no number");
    }
  }
}

}  // namespace

GridRig gridRigOf(const Character& character) {
  if (!character.skin() || character.skin()->rigged())
    throw Error("the character has no skin on its solids");
  if (character.skeleton().jointCount() > 0xffff) throw Error("there are too many joints");
  const CharacterState rest = initialState(character, character.source(-1));
  GridRig rig;
  rig.rest_world = rest.skeleton.joint_world;
  skinSurface(*character.skin(), rest.flesh, rest.skin, rig.surface);
  weld(rig);
  Box box;
  for (const Eigen::Vector3f& p : rig.points_m) box.add(p.cast<double>());
  const std::vector<std::vector<float>> distance_m = distances(character, rest, rig.points_m);
  for (std::size_t i = 0; i < rig.points_m.size(); ++i)
    rig.weights.push_back(guess(distance_m, i, kReach * box.size().norm()));
  return rig;
}

GridFrames gridFramesOf(const Character& character, const GridRig& rig,
                        std::span<const Recording* const> recordings) {
  const Skeleton& skeleton = character.skeleton();
  Posture posture = skeleton.restPosture();
  PosedSkeleton posed;
  GridFrames out;
  for (const Recording* recording : recordings) {
    check(rig, *recording);
    for (const Recording::Frame& frame : recording->frames) {
      if (frame.posture.size() != posture.values.size())
        throw Error("the recording is of another character");
      posture.values = frame.posture;
      skeleton.pose(posture, posed);
      std::vector<Transform>& local = out.local.emplace_back();
      std::vector<Transform>& bones = out.bones.emplace_back();
      for (std::size_t j = 0; j < rig.rest_world.size(); ++j) {
        local.push_back(localFrame(skeleton, posed, j));
        bones.push_back(posed.joint_world[j] * rig.rest_world[j].inverse());
      }
      std::vector<Eigen::Vector3f>& points = out.points.emplace_back(rig.points_m);
      for (std::size_t v = rig.pointOf.size(); v-- > 0;) points[rig.pointOf[v]] = frame.skin_m[v];
    }
  }
  return out;
}

}  // namespace fascia
