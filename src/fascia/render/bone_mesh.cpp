#include <fascia/render/bone_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <unordered_set>

#include <fascia/rig/blend_skinning.h>

namespace fascia {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr std::uint32_t kAround = 20;   // segments
constexpr std::uint32_t kRings = 10;    // of a ball, pole to pole
constexpr double kBallToBone = 0.11;    // a joint ball's radius over its bone's length
constexpr float kLargestBall = 0.015f;  // … and at most, over the size of an imported figure
constexpr double kShortestBone = 2e-3;  // of that size; shorter ones are joints on top of others

// A long bone's outline: place along it and radius, both as a share; knob, shaft, knob.
struct Outline {
  float along, radius;
};
constexpr std::array<Outline, 13> kShaft{{{0.00f, 0.00f},
                                          {0.00f, 0.55f},
                                          {0.03f, 0.92f},
                                          {0.08f, 1.00f},
                                          {0.14f, 0.84f},
                                          {0.24f, 0.56f},
                                          {0.50f, 0.44f},
                                          {0.76f, 0.50f},
                                          {0.87f, 0.72f},
                                          {0.93f, 0.84f},
                                          {0.97f, 0.76f},
                                          {1.00f, 0.45f},
                                          {1.00f, 0.00f}}};

// Adds a surface of revolution about `axis`; each ring has a place on the axis and a radius.
template <class RingAt>
void addRevolution(TriangleMesh& mesh, const Vec3f& axis, std::uint32_t rings, RingAt ringAt) {
  const Vec3f side = axis.unitOrthogonal(), other = axis.cross(side);
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t r = 0; r < rings; ++r) {
    const auto [center, radius_m] = ringAt(r);
    for (std::uint32_t s = 0; s < kAround; ++s) {
      const float a = static_cast<float>(2 * kPi) * static_cast<float>(s) / kAround;
      mesh.positions.push_back(center + radius_m * (std::cos(a) * side + std::sin(a) * other));
    }
  }
  for (std::uint32_t r = 0; r + 1 < rings; ++r)
    for (std::uint32_t s = 0; s < kAround; ++s) {
      const std::uint32_t next = (s + 1) % kAround;
      const std::uint32_t a = base + r * kAround + s, b = base + r * kAround + next;
      const std::uint32_t c = a + kAround, d = b + kAround;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
}

struct Ring {
  Vec3f center;
  float radius_m;
};

void addBall(TriangleMesh& mesh, const Vec3f& center, float radius_m) {
  const Vec3f axis = Vec3f::UnitY();
  addRevolution(mesh, axis, kRings + 1, [&](std::uint32_t r) {
    const float latitude = static_cast<float>(kPi * (static_cast<double>(r) / kRings - 0.5));
    return Ring{center + std::sin(latitude) * radius_m * axis, std::cos(latitude) * radius_m};
  });
}

void addShaft(TriangleMesh& mesh, const Vec3f& from, const Vec3f& to, float maxRadius_m) {
  const float length_m = (to - from).norm();
  const Vec3f axis = length_m > 0 ? Vec3f((to - from) / length_m) : Vec3f(Vec3f::UnitY());
  const float radius_m = std::min(maxRadius_m, 0.16f * length_m);
  addRevolution(mesh, axis, static_cast<std::uint32_t>(kShaft.size()), [&](std::uint32_t r) {
    return Ring{from + kShaft[r].along * (to - from), kShaft[r].radius * radius_m};
  });
}

// The joints' balls get one size, from the mean bone; a lone joint gets a small one.
double ballRadius(const Skeleton& skeleton) {
  double length_m = 0;
  int bones = 0;
  for (std::size_t i = 0; i < skeleton.jointCount(); ++i) {
    const JointId id(static_cast<std::int64_t>(i));
    if (!skeleton.parent(id).valid()) continue;
    length_m += skeleton.joint(id).offset_m.norm();
    ++bones;
  }
  return bones > 0 && length_m > 0 ? kBallToBone * length_m / bones : 0.03;
}

// Which of the skeleton's joints carry points of the rig's surface. Traces of weight do not count:
// files have them where nobody meant them.
std::vector<char> carriers(const Skeleton& skeleton, const RiggedModel& rig,
                           std::span<const std::string> rigNames) {
  std::unordered_set<std::string_view> names;
  for (const std::uint32_t joint : dominantJoints(rig))
    names.insert(rigNames.empty() ? rig.joints[joint].name : rigNames[joint]);
  std::vector<char> out(skeleton.jointCount());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = names.contains(skeleton.joint(JointId(static_cast<std::int64_t>(i))).name);
  return out;
}

// A shaft counts if it lies between carriers, or leads from one to a tip.
std::vector<char> shafts(const Skeleton& skeleton, const std::vector<char>& carries,
                         double shortest_m) {
  const std::size_t count = carries.size();
  std::vector<char> above(carries), below(carries);
  const auto parentOf = [&](std::size_t i) {
    return skeleton.parent(JointId(static_cast<std::int64_t>(i)));
  };
  for (std::size_t i = 0; i < count; ++i)
    if (parentOf(i).valid() && above[parentOf(i).index()]) above[i] = 1;
  for (std::size_t i = count; i-- > 0;)
    if (parentOf(i).valid() && below[i]) below[parentOf(i).index()] = 1;
  std::vector<char> out(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (!parentOf(i).valid()) continue;
    const std::size_t parent = parentOf(i).index();
    const double length_m = skeleton.joint(JointId(static_cast<std::int64_t>(i))).offset_m.norm();
    out[i] = above[parent] && (carries[parent] || below[i]) && length_m > shortest_m;
  }
  return out;
}

}  // namespace

BoneSizes boneSizes(const Skeleton& skeleton) {
  const std::size_t count = skeleton.jointCount();
  return {std::vector<float>(count, static_cast<float>(ballRadius(skeleton))),
          std::vector<char>(count, 1)};
}

BoneSizes boneSizes(const Skeleton& skeleton, const RiggedModel& rig,
                    std::span<const std::string> names) {
  const std::size_t count = skeleton.jointCount();
  const auto size_m = static_cast<float>(rig.size_m());
  BoneSizes sizes;
  sizes.hasShaft = shafts(skeleton, carriers(skeleton, rig, names), kShortestBone * rig.size_m());
  std::vector<float> longest_m(count, 0.f);
  for (std::size_t i = 0; i < count; ++i) {
    if (!sizes.hasShaft[i]) continue;
    const JointId id(static_cast<std::int64_t>(i));
    const auto length_m = static_cast<float>(skeleton.joint(id).offset_m.norm());
    for (const std::size_t end : {i, skeleton.parent(id).index()})
      longest_m[end] = std::max(longest_m[end], length_m);
  }
  for (const float length_m : longest_m)
    sizes.ball_m.push_back(
        std::min(static_cast<float>(kBallToBone) * length_m, kLargestBall * size_m));
  return sizes;
}

TriangleMesh boneMesh(const Skeleton& skeleton, const PosedSkeleton& posed,
                      const BoneSizes& sizes) {
  TriangleMesh mesh;
  for (std::size_t i = 0; i < skeleton.jointCount(); ++i) {
    const JointId parent = skeleton.parent(JointId(static_cast<std::int64_t>(i)));
    const Vec3f here = posed.joint_world[i].translation_m.cast<float>();
    if (sizes.ball_m[i] > 0) addBall(mesh, here, sizes.ball_m[i]);
    if (parent.valid() && sizes.hasShaft[i])
      addShaft(mesh, posed.joint_world[parent.index()].translation_m.cast<float>(), here,
               0.9f * std::max(sizes.ball_m[i], sizes.ball_m[parent.index()]));
  }
  computeNormals(mesh.positions, mesh.triangles, mesh.normals);
  return mesh;
}

}  // namespace fascia
