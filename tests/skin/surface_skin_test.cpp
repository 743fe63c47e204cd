#include <gtest/gtest.h>

#include <fascia/measure/deformation.h>
#include <fascia/skin/skin_fit.h>
#include <fascia/skin/surface/solid_union.h>
#include <fascia/skin/surface/surface_rest.h>

#include "../geometry/closed_mesh.h"
#include "body.h"
#include "test_fields.h"

namespace fascia {
namespace {

using test::Body;
using test::ClosedMesh;

// What stands on one joint that turns, and a second one on top that bends.
Body figureOf(std::vector<FleshSolidDef> solids, double edge_m = 0.03) {
  Body body;
  body.fleshDef.solids = std::move(solids);
  body.skinDef.grid.bottom = body.skinDef.grid.top = {};
  body.skinDef.surface = SkinSurfaceDef{.edge_m = edge_m};
  return body;
}

Body bodyWithArms() {
  return figureOf({test::ball("belly", "hip", Vec3::Zero(), 0.25),
                   test::ball("chest", "hip", Vec3(0, 0.3, 0.02), 0.2),
                   test::ball("head", "neck", Vec3(0, 0.12, 0), 0.13),
                   test::ball("left_arm", "neck", Vec3(0.2, -0.12, 0), 0.08),
                   test::ball("left_hand", "neck", Vec3(0.31, -0.12, 0), 0.07),
                   test::ball("right_arm", "neck", Vec3(-0.2, -0.12, 0), 0.08),
                   test::ball("right_hand", "neck", Vec3(-0.31, -0.12, 0), 0.07)});
}

Body ringOfBalls() {
  std::vector<FleshSolidDef> solids;
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * kPi * i / 24;
    solids.push_back(
        test::ball("b" + std::to_string(i), i < 12 ? "hip" : "neck",
                   Vec3(0.4 * std::cos(a), (i < 12 ? 0.0 : -0.5) + 0.4 * std::sin(a), 0), 0.09));
  }
  return figureOf(std::move(solids));
}

Body crossOfBalls() {
  std::vector<FleshSolidDef> solids;
  for (int i = -8; i <= 8; ++i) {
    solids.push_back(test::ball("x" + std::to_string(i), "hip", Vec3(0.09 * i, 0, 0), 0.07));
    if (i != 0)
      solids.push_back(
          test::ball("y" + std::to_string(i), "neck", Vec3(0, 0.09 * i - 0.5, 0), 0.07));
  }
  return figureOf(std::move(solids));
}

// Of the skin's points, not of what is drawn.
TriangleMesh meshOf(const Skin& skin, const VectorArray& position) {
  TriangleMesh mesh;
  for (std::size_t k = 0; k < skin.pointCount(); ++k)
    mesh.positions.push_back(test::at(position, k).cast<float>());
  mesh.triangles = skin.surface()->triangles;
  return mesh;
}

TEST(SurfaceSkin, IsClosedWithTheHolesOfItsFigure) {
  Body arms = bodyWithArms(), ring = ringOfBalls(), cross = crossOfBalls();
  const std::pair<Body*, long> figures[] = {{&arms, 2}, {&ring, 0}, {&cross, 2}};
  for (const auto& [body, euler] : figures) {
    ASSERT_TRUE(body->build());
    const ClosedMesh found(meshOf(*body->skin, body->skin->restPosition()));
    EXPECT_TRUE(found.closed);
    EXPECT_TRUE(found.manifold);
    EXPECT_EQ(found.euler, euler);
    EXPECT_LT(found.longest, 1.65 * 0.03);
    EXPECT_GT(found.shortest, 0.25 * 0.03);
  }
}

TEST(SurfaceSkin, HoldsAllSolidsAndCrossesNothingAtRest) {
  Body arms = bodyWithArms(), ring = ringOfBalls(), cross = crossOfBalls();
  for (Body* body : {&arms, &ring, &cross}) {
    ASSERT_TRUE(body->build());
    ASSERT_NE(body->skin->fit(), nullptr);
    EXPECT_TRUE(body->skin->fit()->outside.empty());
    EXPECT_EQ(body->skin->fit()->crossings, 0u);
    EXPECT_LT(body->skin->makeContact()->deepest(body->posedFlesh, body->skin->points(),
                                                 body->skin->restPosition()),
              1e-5f);
  }
}

// Turns and bends for a second and stands still for another.
class MovingBody final : public SkinPoseSource {
 public:
  explicit MovingBody(Body& body) : body_(body) {}
  SkinPose at(double time_s) override {
    Posture posture = body_.skeleton.restPosture();
    const double swing = time_s < 1 ? std::sin(2 * kPi * time_s) : 0;
    posture.values = {0.1 * swing, 0.5 * swing, 0.5 * swing};
    body_.pose(posture);
    return body_.skinPose();
  }

 private:
  Body& body_;
};

TEST(SurfaceSkin, StaysOutOfTheFleshAndComesToRestAfterAMotion) {
  Body body = bodyWithArms();
  body.skinDef.material.prestretch = 1.02;
  ASSERT_TRUE(body.build());
  MovingBody poses(body);
  SkinState state;
  placeSkin(*body.skin, poses.at(0), state);
  SkinWorkspace workspace;
  SkinStats stats;
  double farthest = 0;
  for (int f = 0; f < 240; ++f) {
    advanceSkin(*body.skin, poses, f / 60.0, (f + 1) / 60.0, state, workspace, stats);
    measureSkin(*body.skin, poses.at((f + 1) / 60.0), state, stats);
    for (std::size_t k = 0; k < body.skin->pointCount(); ++k) {
      ASSERT_TRUE(test::at(state.position, k).allFinite());
      farthest = std::max(
          farthest, (test::at(state.position, k) - test::at(body.skin->restPosition(), k)).norm());
    }
  }
  EXPECT_GT(farthest, 0.1);  // it went along
  EXPECT_EQ(stats.repaired_points, 0u);
  EXPECT_LT(stats.max_penetration_m, 1e-3);
  const TriangleMesh mesh = meshOf(*body.skin, state.position);
  EXPECT_EQ(crossingTrianglePairs(mesh.triangles, mesh.positions), 0u);
  for (std::size_t k = 0; k < body.skin->pointCount(); ++k)
    EXPECT_LT(test::at(state.velocity, k).norm(), 0.05);
}

TEST(SurfaceSkin, TakesRegionsByJointAndBySolid) {
  Body body = bodyWithArms();
  SkinRegionDef byJoint, bySolid;
  byJoint.name = byJoint.joint = "neck", bySolid.name = bySolid.solid = "belly";
  byJoint.edits = {{SkinQuantity::density, SkinRegionDef::Edit::Mode::set, 9}};
  bySolid.edits = {{SkinQuantity::drag, SkinRegionDef::Edit::Mode::set, 7}};
  body.skinDef.regions = {byJoint, bySolid};
  ASSERT_TRUE(body.build());
  int dense = 0, usual = 0, draggy = 0;
  for (std::size_t k = 0; k < body.skin->pointCount(); ++k) {
    const double height = test::at(body.skin->restPosition(), k).y();
    const float density = body.skin->quantities()[SkinQuantity::density][k];
    EXPECT_TRUE(height < 1.65 || density == 9) << height << " " << density;
    dense += density > 8.99f, usual += density < 4.01f;
    draggy += body.skin->quantities()[SkinQuantity::drag][k] == 7;
  }
  EXPECT_GT(dense, 100);
  EXPECT_GT(usual, 100);
  EXPECT_GT(draggy, 100);
}

TEST(SurfaceSkin, RefusesEdgesThatWouldMakeTooManyPoints) {
  Body body = bodyWithArms();
  body.skinDef.surface->edge_m = 1e-4;
  EXPECT_FALSE(body.build());
  ASSERT_EQ(body.diagnostics.errors().size(), 1u);
  EXPECT_EQ(body.diagnostics.errors()[0].where.pointer, "/skin/surface/edge_m");
  // Edges longer than the figure are an eighth of it.
  body.skinDef.surface->edge_m = 50;
  ASSERT_TRUE(body.build());
  EXPECT_GT(body.skin->pointCount(), 50u);
  EXPECT_TRUE(ClosedMesh(meshOf(*body.skin, body.skin->restPosition())).closed);
}

TEST(SolidUnion, IsNeverFartherThanTheNearestSolidLessTheFat) {
  const test::RigidSolids field = test::RigidSolids()
                                      .addSphere(Vec3(0, 0, 0), 0.3)
                                      .addSphere(Vec3(0.35, 0.1, 0), 0.2)
                                      .addSphere(Vec3(0, 0.4, 0.1), 0.1);
  const ImplicitSurface surface = unionOfSolids(field, {0.02, 0.05});
  float most = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f p =
        Vec3(0.7 * std::sin(0.7 * i), 0.6 * std::cos(1.1 * i), 0.5 * std::sin(0.3 * i + 1))
            .cast<float>();
    float value, nearest = 1e9f;
    Eigen::Vector3f slope, normal;
    surface.evaluate({&p.x(), &p.y(), &p.z(), 1}, &value, {&slope.x(), &slope.y(), &slope.z(), 1});
    for (int s = 0; s < 3; ++s) {
      float d;
      field.evaluate(SolidId(s), {&p.x(), &p.y(), &p.z(), 1}, &d,
                     {&normal.x(), &normal.y(), &normal.z(), 1});
      nearest = std::min(nearest, d);
    }
    EXPECT_LE(value, nearest - 0.02f + 1e-6f);
    most = std::max(most, nearest - 0.02f - value);
    for (int a = 0; a < 3; ++a) {
      constexpr float kStep = 1e-3f;
      float ahead, behind;
      const Eigen::Vector3f up = p + kStep * Eigen::Vector3f::Unit(a),
                            down = p - kStep * Eigen::Vector3f::Unit(a);
      surface.evaluate({&up.x(), &up.y(), &up.z(), 1}, &ahead,
                       {&normal.x(), &normal.y(), &normal.z(), 1});
      surface.evaluate({&down.x(), &down.y(), &down.z(), 1}, &behind,
                       {&normal.x(), &normal.y(), &normal.z(), 1});
      EXPECT_NEAR((ahead - behind) / (2 * kStep), slope[a], 2e-3f);
    }
  }
  EXPECT_GT(most, 0.005f);  // somewhere solids blend
}

TEST(SkinFit, NamesWhatATubeLeavesOutside) {
  Body straight;
  ASSERT_TRUE(straight.build());
  EXPECT_TRUE(straight.skin->fit()->outside.empty());
  EXPECT_EQ(straight.skin->fit()->crossings, 0u);

  Body ring = ringOfBalls();
  ring.skinDef.surface.reset();
  ring.skinDef.grid.bottom.joint = "hip", ring.skinDef.grid.top.joint = "neck";
  ASSERT_TRUE(ring.build());
  EXPECT_GT(ring.skin->fit()->outside.size(), 4u);
  Diagnostics diagnostics;
  warnOfSkinFit(*ring.skin->fit(), ring.flesh, true, "/skin", diagnostics);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  const std::string text = diagnostics.warnings()[0].text();
  EXPECT_NE(text.find("of 24 solids outside: 'b"), std::string::npos) << text;
  EXPECT_NE(text.find("\"surface\""), std::string::npos) << text;
}

}  // namespace
}  // namespace fascia
