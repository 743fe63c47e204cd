#include <fascia/pose/morph_shapes.h>

#include <gtest/gtest.h>

#include "limb.h"

namespace fascia {
namespace {

// Two morphs that overlap, the second half there at rest.
std::vector<RigMorph> bumps() {
  RigMorph a, b;
  a.points = {2, 3, 40}, a.displacement_m = {{0.01f, 0, 0}, {0, 0.02f, 0}, {0, 0, 0.03f}};
  b.points = {3, 41}, b.displacement_m = {{0, 0, 0.04f}, {0.02f, 0.01f, 0}}, b.rest = 0.5f;
  return {a, b};
}

VectorArray evaluated(const PoseSkin& skin, const std::vector<Transform>& motion,
                      const std::vector<double>& weights) {
  PoseSkin::Scratch scratch;
  VectorArray out(skin.pointCount());
  skin.evaluate(motion, {.morphs = weights}, scratch, out);
  return out;
}

Vec3 pointOf(const VectorArray& points, std::size_t i) {
  return Vec3(double{points.x[i]}, double{points.y[i]}, double{points.z[i]});
}

TEST(MorphShapes, AddTheirTurnedDisplacementsToThePose) {
  const test::Limb limb;
  const std::vector<RigMorph> morphs = bumps();
  PoseSource source = limb.source();
  source.morphs = morphs;
  const PoseSkin with(source, {}), without = limb.skin();
  ASSERT_EQ(with.morphCount(), 2u);
  Transform all;
  all.rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  all.translation_m = Vec3(3, 1, -2);
  const std::vector<Transform> motion(3, all);
  const VectorArray plain = evaluated(without, motion, {});
  const VectorArray shaped = evaluated(with, motion, {0.8, -1});
  for (std::size_t i = 0; i < with.pointCount(); ++i) {
    Vec3 d = Vec3::Zero();
    for (std::size_t m = 0; m < 2; ++m)
      for (std::size_t k = 0; k < morphs[m].points.size(); ++k)
        if (morphs[m].points[k] == i)
          d += (m == 0 ? 0.8 : -1.5) * morphs[m].displacement_m[k].cast<double>();
    EXPECT_LT((pointOf(shaped, i) - pointOf(plain, i) - all.rotation * d).norm(), 1e-6) << i;
  }
}

TEST(MorphShapes, AtRestAreTheBitsOfASkinWithoutAny) {
  const test::Limb limb;
  const std::vector<RigMorph> morphs = bumps();
  PoseSource source = limb.source();
  source.morphs = morphs;
  const PoseSkin with(source, {});
  const std::vector<Transform> motion = limb.turned(1.2);
  const VectorArray plain = evaluated(limb.skin(), motion, {});
  for (const std::vector<double>& weights : {std::vector<double>{}, std::vector<double>{0, 0.5}}) {
    const VectorArray shaped = evaluated(with, motion, weights);
    EXPECT_EQ(shaped.x, plain.x);
    EXPECT_EQ(shaped.y, plain.y);
    EXPECT_EQ(shaped.z, plain.z);
  }
}

}  // namespace
}  // namespace fascia
