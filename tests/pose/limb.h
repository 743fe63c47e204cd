#pragma once

#include <cmath>
#include <vector>

#include <fascia/pose/pose_skin.h>

namespace fascia::test {

// A round limb along x with closed ends, about two bones whose joint is half way, blended over
// `blend_m` around it: an arm. Names as a rig has them.
struct Limb {
  static constexpr double kJoint_m = 0.3, kLength_m = 0.6, kRadius_m = 0.05;
  std::vector<Eigen::Vector3f> points;
  std::vector<PointWeights> weights;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<RigJoint> joints{{"upper_arm", -1, {}}, {"lower_arm", 0, {}}, {"hand", 1, {}}};

  explicit Limb(int around = 24, int along = 60, double blend_m = 0.1, double from_m = 0) {
    joints[0].rest_world.translation_m = Vec3(from_m, 0, 0);
    joints[1].rest_world.translation_m = Vec3(from_m + kJoint_m, 0, 0);
    joints[2].rest_world.translation_m = Vec3(from_m + kLength_m, 0, 0);
    for (int i = 0; i <= along; ++i) {
      const double x = kLength_m * (0.5 - 0.5 * std::cos(kPi * i / along));
      const double inner = std::min({x, kLength_m - x, kRadius_m}) / kRadius_m;
      const double radius = kRadius_m * std::sqrt(inner * (2 - inner));
      const int count = i == 0 || i == along ? 1 : around;
      for (int j = 0; j < count; ++j) {
        const double a = 2 * kPi * j / around;
        points.push_back(
            Eigen::Vector3d(from_m + x, radius * std::cos(a), radius * std::sin(a)).cast<float>());
        weights.push_back(weightsAt(x, blend_m));
      }
    }
    const auto ring = [&](int i, int j) {
      return static_cast<std::uint32_t>(1 + (i - 1) * around + j % around);
    };
    const auto last = static_cast<std::uint32_t>(points.size() - 1);
    for (int j = 0; j < around; ++j) {
      triangles.push_back({0, ring(1, j + 1), ring(1, j)});
      for (int i = 1; i + 1 < along; ++i) {
        triangles.push_back({ring(i, j), ring(i, j + 1), ring(i + 1, j)});
        triangles.push_back({ring(i, j + 1), ring(i + 1, j + 1), ring(i + 1, j)});
      }
      triangles.push_back({last, ring(along - 1, j), ring(along - 1, j + 1)});
    }
  }
  static PointWeights weightsAt(double x, double blend_m) {
    const double t = std::clamp(0.5 + (x - kJoint_m) / blend_m, 0.0, 1.0);
    const auto fore = static_cast<float>(t * t * (3 - 2 * t));
    PointWeights w;
    w.joint = {static_cast<std::uint16_t>(fore > 0.5f ? 1 : 0),
               static_cast<std::uint16_t>(fore > 0.5f ? 0 : 1)};
    w.weight[0] = std::max(fore, 1 - fore);
    w.weight[1] = 1 - w.weight[0];
    return w;
  }
  PoseSource source() const { return {points, weights, triangles, joints}; }
  PoseSkin skin(const PoseDials& dials = {}) const { return PoseSkin(source(), dials); }
  PoseDials dials(float jiggle, float muscle, float volume) const {
    PoseDials d;
    d.jiggle.assign(points.size(), jiggle);
    d.muscle.assign(points.size(), muscle);
    d.volume.assign(points.size(), volume);
    return d;
  }

  // Rest -> now with the forearm turned about an axis through its joint, all of it moved by `all`.
  std::vector<Transform> turned(double angle_rad, const Vec3& axis = Vec3::UnitZ(),
                                const Transform& all = {}) const {
    const Vec3 at = joints[1].rest_world.translation_m;
    Transform turn;
    turn.rotation = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
    turn.translation_m = at - turn.rotation * at;
    return {all, all * turn, all * turn};
  }
};

struct Evaluation {
  PoseSkin::Scratch scratch;
  VectorArray out;

  std::vector<Eigen::Vector3f> operator()(const PoseSkin& skin, std::span<const Transform> motion,
                                          const PoseSkin::Moment& moment = {}) {
    out.resize(skin.pointCount());
    skin.evaluate(motion, moment, scratch, out);
    std::vector<Eigen::Vector3f> points;
    for (std::size_t i = 0; i < skin.pointCount(); ++i)
      points.push_back({out.x[i], out.y[i], out.z[i]});
    return points;
  }
};

inline std::vector<Eigen::Vector3f> posed(const PoseSkin& skin, std::span<const Transform> motion) {
  Evaluation evaluate;
  return evaluate(skin, motion);
}

inline float farthest(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b) {
  float most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

}  // namespace fascia::test
