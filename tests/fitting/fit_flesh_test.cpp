#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/fitting/fit_flesh.h>
#include <fascia/fitting/rest_surface.h>
#include <fascia/skeleton/skeleton.h>

#include "fitting/rigs.h"

namespace fascia {
namespace {

using namespace testing;

RiggedModel armPair() {
  RiggedModel model;
  addJoint(model, "chest", -1, Vec3(0, 1, 0));
  addEllipsoid(model, Vec3(0, 1, 0), Vec3(0.15, 0.25, 0.1),
               [](const Vec3&) { return onlyJoint(0); });
  addArm(model, 0, 1, ".L");
  addArm(model, 0, -1, ".R");
  return model;
}

const FleshFit& armPairFit() {
  static const FleshFit fit = fitFlesh(armPair());
  return fit;
}

const JointFit& of(const FleshFit& fit, const std::string& joint) {
  for (const JointFit& one : fit.joints) {
    if (one.joint == joint) return one;
  }
  throw std::runtime_error("no joint " + joint);
}

TEST(FitFlesh, FillsEveryPartAndStaysInside) {
  const FleshFit& fit = armPairFit();
  EXPECT_EQ(fit.joints.size(), 7u);
  for (const char* joint : {"chest", "upper_arm.L", "forearm.L", "upper_arm.R", "forearm.R"}) {
    EXPECT_FALSE(of(fit, joint).solids.empty()) << joint;
    EXPECT_GT(of(fit, joint).coverage, 0.95) << joint;
    EXPECT_LT(of(fit, joint).residual_rms_m, 0.012) << joint;
  }
  EXPECT_GT(fit.coverage, 0.95);
  EXPECT_EQ(fit.deepest_outside_m, 0);
}

const FleshSolidDef& solidOf(const FleshFit& fit, const std::string& name) {
  for (const FleshSolidDef& one : fit.flesh.solids) {
    if (one.name == name) return one;
  }
  throw std::runtime_error("no solid " + name);
}

// Two bones whose elbow bends about z by up to 1.2 rad.
RiggedModel bendingArmPair() {
  RiggedModel model = armPair();
  SampledMotion motion;
  motion.joints = {"forearm.L"};
  motion.translation_m.assign(20, Eigen::Vector3f(0.3f, 0, 0));
  for (int i = 0; i < 20; ++i)
    motion.rotation.emplace_back(
        Eigen::AngleAxisf(0.063f * static_cast<float>(i), Eigen::Vector3f::UnitZ()));
  model.motions.push_back(motion);
  return model;
}

TEST(FitFlesh, TurnsAJointsXAxisIntoItsBend) {
  const FleshFit fit = fitFlesh(bendingArmPair());
  Diagnostics diagnostics;
  const Skeleton skeleton(fit.skeleton, "", diagnostics);
  ASSERT_TRUE(diagnostics.ok());
  PosedSkeleton posed;
  skeleton.pose(skeleton.restPosture(), posed);
  const auto frame = [&](const char* name) {
    return posed.joint_world[skeleton.find(name).index()];
  };
  EXPECT_LT((frame("forearm.L").translation_m - Vec3(0.5, 1, 0)).norm(), 1e-6);
  EXPECT_LT((frame("forearm.L").rotation.col(0) - Vec3::UnitZ()).norm(), 1e-5);
  EXPECT_LT((frame("forearm.L").rotation.col(1) - Vec3::UnitX()).norm(), 1e-5);
  // The mirrored elbow has no motion of its own: it bends as its image does.
  EXPECT_LT((frame("forearm.R").rotation.col(0) + Vec3::UnitZ()).norm(), 1e-5);
  EXPECT_LT((frame("forearm.R").rotation.col(1) + Vec3::UnitX()).norm(), 1e-5);
}

TEST(FitFlesh, PutsFlexorsWhereTheElbowBendsToAndLetsThemSwell) {
  const FleshFit fit = fitFlesh(bendingArmPair());
  const FleshSolidDef& biceps = solidOf(fit, "upper_arm.L biceps");
  Diagnostics diagnostics;
  const Skeleton skeleton(fit.skeleton, "", diagnostics);
  PosedSkeleton posed;
  skeleton.pose(skeleton.restPosture(), posed);
  const Vec3 at = posed.joint_world[skeleton.find("upper_arm.L").index()].point(biceps.position_m);
  EXPECT_GT(at.y(), 1.01);  // +rz lifts the forearm
  ASSERT_EQ(biceps.drivers.size(), 3u);
  const std::size_t count = biceps.drivers[0].points.size();
  for (std::size_t i = 0; i < count; ++i) {
    double volume = 1, rest = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(biceps.drivers[axis].joint, "forearm.L");
      volume *= biceps.drivers[axis].points[i].parameter;
      rest *= biceps.solid.parameters[axis];
    }
    EXPECT_NEAR(volume / rest, 1, 1e-12);
  }
  EXPECT_GT(biceps.drivers[0].points.back().parameter, 1.05 * biceps.solid.parameters[0]);
  EXPECT_LT(biceps.drivers[2].points.back().parameter, 0.9 * biceps.solid.parameters[2]);
}

TEST(FitFlesh, SaysWhyAJointHasNone) {
  const FleshFit& fit = armPairFit();
  EXPECT_TRUE(of(fit, "hand.L").solids.empty());
  EXPECT_EQ(of(fit, "hand.L").points, 0u);
  EXPECT_NE(of(fit, "hand.L").why.find("no skin"), std::string::npos);
  EXPECT_TRUE(of(fit, "chest").why.empty());
}

TEST(FitFlesh, MirrorImagesGetMirrorImages) {
  const FleshFit& fit = armPairFit();
  Diagnostics diagnostics;
  const Skeleton skeleton(fit.skeleton, "", diagnostics);
  const Flesh flesh(fit.flesh, skeleton, "", diagnostics);
  ASSERT_TRUE(diagnostics.ok());
  PosedSkeleton posed;
  const Posture rest = skeleton.restPosture();
  skeleton.pose(rest, posed);
  PosedFlesh posedFlesh;
  flesh.pose(rest, posed, {}, posedFlesh);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < flesh.solidCount(); ++i) {
    const SolidId left{static_cast<std::int64_t>(i)};
    std::string name = flesh.def(left).name;
    const std::size_t at = name.find(".L");
    if (at == std::string::npos) continue;
    ++pairs;
    name[at + 1] = 'R';
    const SolidId right = flesh.find(name);
    ASSERT_TRUE(right.valid()) << name;
    const Vec3 a = posedFlesh.frame(left).translation_m, b = posedFlesh.frame(right).translation_m;
    EXPECT_LT((Vec3(-a.x(), a.y(), a.z()) - b).norm(), 1e-9) << name;
    EXPECT_EQ(flesh.def(left).solid.parameters, flesh.def(right).solid.parameters) << name;
  }
  EXPECT_GE(pairs, 2u);
}

TEST(FitFlesh, GivesTheSameBitsOnAnyNumberOfThreads) {
  const RiggedModel model = armPair();
  const auto bits = [&](int threads) {
    const ThreadLimit limit(threads);
    const FleshFit fit = fitFlesh(model);
    std::vector<double> all{fit.coverage, fit.residual_rms_m};
    for (const FleshSolidDef& solid : fit.flesh.solids) {
      all.insert(all.end(), solid.solid.parameters.begin(), solid.solid.parameters.end());
      all.insert(all.end(), solid.position_m.begin(), solid.position_m.end());
      all.insert(all.end(), solid.orientation_rad.begin(), solid.orientation_rad.end());
    }
    return all;
  };
  EXPECT_EQ(bits(1), bits(4));
}

TEST(FitFlesh, LeavesAThinSheetEmpty) {
  RiggedModel model;
  addJoint(model, "root", -1, Vec3(0, 0, 0));
  addJoint(model, "wing", 0, Vec3(0, 1, 0));
  addEllipsoid(model, Vec3(0, 0, 0), Vec3::Constant(0.3), [](const Vec3&) { return onlyJoint(0); });
  addEllipsoid(model, Vec3(0, 1, 0), Vec3(0.5, 0.3, 0.001),
               [](const Vec3&) { return onlyJoint(1); });
  const FleshFit fit = fitFlesh(model);
  EXPECT_FALSE(of(fit, "root").solids.empty());
  EXPECT_TRUE(of(fit, "wing").solids.empty());
  EXPECT_NE(of(fit, "wing").why.find("thin"), std::string::npos);
}

TEST(FitFlesh, LeavesAnOpenSheetEmpty) {
  RiggedModel model;
  addJoint(model, "ribbon", -1, Vec3(0, 0, 0));
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 2; ++j) {
      model.points_m.emplace_back(0.2f * static_cast<float>(j), 0.2f * static_cast<float>(i), 0.f);
      model.weights.push_back(onlyJoint(0));
      model.component.push_back(0);
    }
  }
  model.componentCount = 1;
  for (std::uint32_t i = 0; i < 10; ++i) {
    for (std::uint32_t j = 0; j < 2; ++j) {
      const std::uint32_t a = 3 * i + j;
      model.triangles.push_back({a, a + 1, a + 3});
      model.triangles.push_back({a + 1, a + 4, a + 3});
    }
  }
  const FleshFit fit = fitFlesh(model);
  EXPECT_TRUE(fit.flesh.solids.empty());
  EXPECT_EQ(fit.coverage, 0);
}

TEST(RestSurface, MeasuresTheRadiusOfABall) {
  RiggedModel model;
  addJoint(model, "root", -1, Vec3::Zero());
  addEllipsoid(model, Vec3::Zero(), Vec3::Constant(0.5), [](const Vec3&) { return onlyJoint(0); });
  const RestSurface surface(model, {});
  EXPECT_NEAR(surface.area_m2(), kPi, 0.05);
  double area_m2 = 0;
  for (const SurfaceSample& s : surface.samples()) {
    area_m2 += s.area_m2;
    // cos² 35° of the diameter for the ring's rays, all of it for the middle one.
    EXPECT_NEAR(s.radius_m, 0.5 * std::pow(std::cos(radians(35)), 2), 0.03);
  }
  EXPECT_NEAR(area_m2, surface.area_m2(), 1e-9);
  EXPECT_TRUE(surface.inside(Vec3(0.1, 0.2, 0.3)));
  EXPECT_FALSE(surface.inside(Vec3(0.4, 0.4, 0.4)));
  EXPECT_NEAR(surface.signedDistance(Vec3(0, 0.2, 0)), -0.3, 0.01);
}

}  // namespace
}  // namespace fascia
