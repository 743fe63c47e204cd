#pragma once

#include <functional>

#include <fascia/base/random.h>
#include <fascia/math/rotation_vector.h>
#include <fascia/skeleton/euler.h>
#include <fascia/track/ball_joints.h>
#include <gtest/gtest.h>

namespace fascia::test {

inline std::vector<DofDef> ballDofs() {
  return {{Dof::rx}, {Dof::ry}, {Dof::rz}};
}

// A hip that moves, a spine of ball joints, an arm: ball, hinge, hinge; on it a ball that swells;
// and a skin with two morphs.
struct Figure {
  Skeleton skeleton;
  Flesh flesh;
  Morphs morphs{{{"smile", 0}, {"frown", 0.25}}};

  operator fascia::Figure() const { return {skeleton, flesh, morphs}; }  // NOLINT: one of these

  Figure() {
    SkeletonDef def;
    def.joints = {
        {"hip", "", {0, 1, 0}, {0, 0, 0}, {{Dof::tx}, {Dof::ty}}},
        {"spine", "hip", {0, 0.2, 0}, {0.1, 0, 0}, ballDofs()},
        {"shoulder", "spine", {0.2, 0.3, 0}, {0, 0.2, -0.3}, ballDofs()},
        {"elbow", "shoulder", {0.3, 0, 0}, {0, 0, 0}, {{Dof::ry, -2.5, 0.1, -0.2}}},
        {"wrist", "elbow", {0.25, 0, 0}, {0, 0, 0}, {{Dof::rz, -0.8, 0.8}, {Dof::ry, -0.3, 0.3}}}};
    FleshDef solids;
    FleshSolidDef& fist = solids.solids.emplace_back();
    fist.name = "fist", fist.joint = "wrist";
    fist.solid.shape = "sphere", fist.solid.parameters = {0.05};
    Diagnostics diagnostics;
    skeleton = Skeleton(def, "/skeleton", diagnostics);
    flesh = Flesh(solids, skeleton, "/solids", diagnostics);
    diagnostics.throwIfErrors();
  }
  JointId joint(const char* name) const { return skeleton.find(name); }
  std::size_t value(const char* name, Dof dof) const {
    return static_cast<std::size_t>(skeleton.valueIndex(joint(name), dof));
  }
};

// Everything swings, each value at a speed of its own; ball joints as rotations where asked for.
class Swing final : public PostureSource {
 public:
  Swing(const Figure& figure, std::uint64_t seed, bool rotations = false)
      : figure_(figure), seed_(seed), rotations_(rotations) {}

  void sample(double time_s, PostureSample& out) const override {
    Random random(seed_);
    out.posture = figure_.skeleton.restPosture();
    for (std::size_t v = 0; v < out.posture.values.size(); ++v) {
      const double speed = random.uniform(1, 4), phase = random.uniform(0, 6);
      out.posture.values[v] += 0.25 * std::sin(speed * time_s + phase);
      out.posture.rates[v] = 0.25 * speed * std::cos(speed * time_s + phase);
    }
    if (rotations_) {
      const Vec3 axis = Vec3(0.3, 1, random.uniform(-1, 1)).normalized();
      const double speed = random.uniform(0.5, 1);
      out.posture.rotations = {
          {figure_.joint("spine"), rotationOf(speed * time_s * axis), speed * axis}};
    }
    out.parameters = {{SolidId(0), 0, 0.06 + 0.01 * std::sin(3 * time_s + double(seed_)),
                       0.03 * std::cos(3 * time_s + double(seed_))}};
    out.morphs.weights = {0.5 + 0.4 * std::sin(2 * time_s + double(seed_)), 0.25};
    out.morphs.rates = {0.8 * std::cos(2 * time_s + double(seed_)), 0};
  }

 private:
  const Figure& figure_;
  std::uint64_t seed_;
  bool rotations_;
};

// A source's sample, fit, and the skeleton in it.
struct Seen {
  PostureSample sample;
  PosedSkeleton posed;

  Seen(const Figure& figure, const PostureSource& source, double time_s) {
    ask(source, time_s, sample);
    admit(figure, {}, sample);
    figure.skeleton.pose(sample.posture, posed);
  }
};

// Every joint moves as its frame does: the rates are the derivatives of the values.
inline void expectRatesAreDerivatives(const Figure& figure, const PostureSource& source,
                                      double time_s, double tolerance = 1e-6, double h = 1e-5) {
  const Seen now(figure, source, time_s), before(figure, source, time_s - h),
      after(figure, source, time_s + h);
  double fastest = 0;
  for (std::size_t j = 0; j < figure.skeleton.jointCount(); ++j) {
    const Transform &a = before.posed.joint_world[j], &b = after.posed.joint_world[j];
    const Vec3 linear = (b.translation_m - a.translation_m) / (2 * h);
    const Vec3 angular = vectorOf(Quat(Mat3(b.rotation * a.rotation.transpose()))) / (2 * h);
    const Twist& twist = now.posed.twist_world[j];
    EXPECT_LT((twist.linear_m_per_s - linear).norm(), tolerance)
        << "joint " << j << " at " << time_s;
    EXPECT_LT((twist.angular_rad_per_s - angular).norm(), tolerance)
        << "joint " << j << " at " << time_s;
    fastest = std::max({fastest, linear.norm(), angular.norm()});
  }
  ASSERT_GT(fastest, 0.01);
}

// The radius that the fist has in the end, from parameters that may be there by a share only.
inline double radiusOf(const PostureSample& sample, double rest_m = 0.05) {
  double radius_m = rest_m;
  for (const Flesh::ParameterOverride& o : sample.parameters)
    radius_m += o.weight * (o.value - radius_m);
  return radius_m;
}
inline double radiusRateOf(const PostureSample& sample, double rest_m = 0.05) {
  double radius_m = rest_m, rate = 0;
  for (const Flesh::ParameterOverride& o : sample.parameters) {
    rate += o.weight * (o.rate - rate) + o.weightRate_per_s * (o.value - radius_m);
    radius_m += o.weight * (o.value - radius_m);
  }
  return rate;
}

}  // namespace fascia::test
