#include <gtest/gtest.h>

#include "body.h"

namespace fascia {
namespace {

using test::Body;
using Mode = SkinRegionDef::Edit::Mode;

float valueAt(const Body& body, SkinQuantity quantity, int i, int j) {
  return body.skin->quantities()[quantity][body.skin->grid()->layout().at(i, j)];
}

TEST(SkinBuilder, SpreadsMassAndStiffnessPerAreaAtEveryResolution) {
  double mass[2];
  for (int n = 0; n < 2; ++n) {
    Body body;
    body.skinDef.grid.columns = 24 << n, body.skinDef.grid.rows = 32 << n;
    ASSERT_TRUE(body.build());
    mass[n] = 0;
    for (const float m : body.skin->points().mass) mass[n] += m;
  }
  // Between the belly alone and spheres that do not overlap, at 4 kg/m² and 1 cm of fat.
  const auto sphere = [](double r) { return 4 * 4 * kPi * (r + 0.01) * (r + 0.01); };
  EXPECT_GT(mass[0], sphere(0.3));
  EXPECT_LT(mass[0], sphere(0.3) + sphere(0.2) + sphere(0.15));
  EXPECT_NEAR(mass[1] / mass[0], 1, 0.03);
}

TEST(SkinBuilder, FixesItsEndRowsToTheirJoints) {
  Body body;
  ASSERT_TRUE(body.build());
  const Skin& skin = *body.skin;
  ASSERT_EQ(skin.grid()->fixed().size(), 2u * 16);
  for (const GridAttachment::Fixed& f : skin.grid()->fixed()) {
    EXPECT_EQ(skin.points().free[f.point], 0);
    const Vec3 world = body.posedSkeleton.joint_world[f.joint.index()].point(f.position_joint);
    EXPECT_LT((world - test::at(skin.restPosition(), f.point)).norm(), 1e-6);
  }
  EXPECT_EQ(skin.points().free[skin.grid()->layout().at(3, 1)], 1);
}

TEST(SkinBuilder, AnchorsEveryFreePointOnTheSurfaceBelowIt) {
  Body body;
  ASSERT_TRUE(body.build());
  const Skin& skin = *body.skin;
  ASSERT_EQ(skin.grid()->anchors().anchors().size(), 16u * 22);
  VectorArray normal(skin.grid()->layout().storage());
  gridNormals(skin.grid()->layout(), skin.restPosition(), 0, skin.grid()->rows(), normal);
  for (const TissueAnchors::Anchor& a : skin.grid()->anchors().anchors()) {
    const Vec3 inner = body.posedFlesh.worldFromMaterial(a.solid, a.material);
    EXPECT_NEAR(body.distanceTo(a.solid, inner), 0, 2e-4);
    // The strand is as long at rest as it was when it was attached.
    const double length = (test::at(skin.restPosition(), a.point) - inner).norm();
    EXPECT_NEAR(skin.points().tissueRestLength[a.point], length, 1e-5);
    EXPECT_GT(skin.points().tissueStiffness[a.point], 0);
  }
}

TEST(TissueAnchors, MoveWithTheirJointAndStayOnTheSurface) {
  Body body;
  ASSERT_TRUE(body.build());
  Posture posture = body.skeleton.restPosture();
  posture.values = {0.4, 0.9, -1.1};
  body.pose(posture);
  VectorArray scratch, anchor(body.skin->grid()->layout().storage());
  body.skin->grid()->anchors().place(body.posedFlesh, scratch, anchor);
  int onHead = 0;
  for (const TissueAnchors::Anchor& a : body.skin->grid()->anchors().anchors()) {
    const Vec3 inner = test::at(anchor, a.point);
    EXPECT_NEAR(body.distanceTo(a.solid, inner), 0, 2e-4);
    const Transform& joint = body.posedSkeleton.joint_world[body.flesh.joint(a.solid).index()];
    const Vec3 inJoint = a.material + body.flesh.def(a.solid).position_m;
    EXPECT_LT((joint.point(inJoint) - inner).norm(), 1e-5);
    onHead += a.solid == body.flesh.find("head");
  }
  EXPECT_GT(onHead, 20);
}

TEST(SkinRegion, SetsScalesAndAddsInsideAndFadesOverItsFeather) {
  Body body;
  const SkinQuantity fat = SkinQuantity::fat;
  SkinRegionDef region{"belt", {}, {}, {}, {}, "", "", 0.1, {{fat, Mode::set, 0.05}}};
  region.u_min = 0, region.u_max = 1, region.v_min = 0.3, region.v_max = 0.6;
  body.skinDef.regions = {region};
  body.skinDef.grid.rows = 41;
  ASSERT_TRUE(body.build());
  for (const int i : {0, 7, 15}) {
    EXPECT_FLOAT_EQ(valueAt(body, fat, i, 18), 0.05f);
    EXPECT_FLOAT_EQ(valueAt(body, fat, i, 26), 0.03f);  // half of the feather away: v = 0.65
    EXPECT_FLOAT_EQ(valueAt(body, fat, i, 29), 0.01f);  // v = 0.725
    EXPECT_FLOAT_EQ(valueAt(body, fat, i, 7), 0.01f);
  }
  body.skinDef.regions[0].edits = {{fat, Mode::scale, 3}, {SkinQuantity::stretch_u, Mode::add, 50}};
  ASSERT_TRUE(body.build());
  EXPECT_FLOAT_EQ(valueAt(body, fat, 4, 18), 0.03f);
  EXPECT_FLOAT_EQ(valueAt(body, SkinQuantity::stretch_u, 4, 18), 200);
  EXPECT_FLOAT_EQ(valueAt(body, SkinQuantity::stretch_v, 4, 18), 150);
}

TEST(SkinRegion, WrapsAroundTheSeam) {
  Body body;
  SkinRegionDef region;
  region.u_min = 0.8, region.u_max = 0.2, region.feather = 0;
  region.edits = {{SkinQuantity::density, Mode::set, 9}};
  body.skinDef.regions = {region};
  ASSERT_TRUE(body.build());
  for (int i = 0; i < 16; ++i) {
    const double u = i / 16.0;
    EXPECT_FLOAT_EQ(valueAt(body, SkinQuantity::density, i, 10), u <= 0.2 || u >= 0.8 ? 9 : 4) << u;
  }
}

TEST(SkinRegion, CanBeAllPointsOfASolid) {
  Body body;
  SkinRegionDef region;
  region.solid = "head";
  region.edits = {{SkinQuantity::drag, Mode::set, 77}};
  body.skinDef.regions = {region};
  ASSERT_TRUE(body.build());
  const SolidId head = body.flesh.find("head");
  int changed = 0;
  for (const TissueAnchors::Anchor& a : body.skin->grid()->anchors().anchors()) {
    const float drag = body.skin->quantities()[SkinQuantity::drag][a.point];
    EXPECT_FLOAT_EQ(drag, a.solid == head ? 77 : 4);
    changed += a.solid == head;
  }
  EXPECT_GT(changed, 20);
}

TEST(SkinBrush, AddsAGaussianAroundAPointOfAJoint) {
  Body body;
  SkinBrushDef brush;
  brush.joint = "neck", brush.center_m = Vec3(0, 0.15, 0.16), brush.radius_m = 0.08;
  brush.amount = 0.03;
  body.skinDef.brushes = {brush};
  ASSERT_TRUE(body.build());
  const Vec3 center(0, 1.65, 0.16);
  double largest = 0;
  test::forEachPoint(body.skin->grid()->layout(), [&](int, int, std::size_t k) {
    const double r = (test::at(body.skin->restPosition(), k) - center).norm() / 0.08;
    const double expected = 0.01 + 0.03 * std::exp(-0.5 * r * r);
    const double fat = body.skin->quantities()[SkinQuantity::fat][k];
    EXPECT_NEAR(fat, expected, 1e-6);
    largest = std::max(largest, fat);
  });
  EXPECT_GT(largest, 0.03);
}

TEST(SkinBrush, NeverMakesFatNegative) {
  Body body;
  SkinBrushDef brush;
  brush.joint = "hip", brush.radius_m = 1, brush.amount = -0.5;
  body.skinDef.brushes = {brush};
  ASSERT_TRUE(body.build());
  test::forEachPoint(body.skin->grid()->layout(), [&](int i, int j, std::size_t) {
    EXPECT_EQ(valueAt(body, SkinQuantity::fat, i, j), 0);
  });
}

TEST(SkinAnchor, TiesThePointNearestToItsCoordinatesToASolid) {
  Body body;
  body.skinDef.grid.anchors = {{0.5, 0.5, "head", Vec3(0, 0, 3)}};
  ASSERT_TRUE(body.build());
  const std::size_t k = body.skin->grid()->layout().at(8, 12);  // round(0.5 · 23) = 12
  int found = 0;
  for (const TissueAnchors::Anchor& a : body.skin->grid()->anchors().anchors()) {
    if (a.point != k) continue;
    ++found;
    EXPECT_EQ(a.solid, body.flesh.find("head"));
    EXPECT_LT((a.material - Vec3(0, 0, 0.15)).norm(), 1e-5);
  }
  EXPECT_EQ(found, 1);
}

TEST(SkinPoints, ReplaceDefaultsPointByPointAndAreResampledToOtherGrids) {
  Body body;
  SkinPointsDef points;
  points.columns = 16, points.rows = 24;
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 16; ++i)
      points.fat.edit().push_back(0.01f + 0.001f * static_cast<float>(j));
  body.skinDef.points = points;
  ASSERT_TRUE(body.build());
  EXPECT_FLOAT_EQ(valueAt(body, SkinQuantity::fat, 5, 17), 0.027f);
  EXPECT_FLOAT_EQ(valueAt(body, SkinQuantity::density, 5, 17), 4);
  body.skinDef.grid.rows = 47;
  ASSERT_TRUE(body.build());
  EXPECT_NEAR(valueAt(body, SkinQuantity::fat, 5, 33), 0.01 + 0.001 * 16.5, 1e-6);
}

TEST(SkinPoints, SavedRestShapeAndAnchorsComeBackExactly) {
  Body body;
  ASSERT_TRUE(body.build());
  const Skin& skin = *body.skin;
  SkinPointsDef saved;
  saved.columns = 16, saved.rows = 24;
  saved.anchor_solid.edit().assign(skin.pointCount(), -1);
  saved.anchor.edit().resize(skin.pointCount());
  for (std::size_t p = 0; p < skin.pointCount(); ++p) {
    const Vec3 r = test::at(skin.restPosition(), skin.storageIndex(p));
    saved.rest_position_m.edit().push_back(
        {static_cast<float>(r.x()), static_cast<float>(r.y()), static_cast<float>(r.z())});
    for (const TissueAnchors::Anchor& a : skin.grid()->anchors().anchors()) {
      if (a.point != skin.storageIndex(p)) continue;
      saved.anchor_solid.edit()[p] = a.solid.value;
      for (std::size_t c = 0; c < 3; ++c)
        saved.anchor.edit()[p][c] = static_cast<float>(a.material[static_cast<Eigen::Index>(c)]);
    }
  }
  Body again;
  again.skinDef.points = saved;
  ASSERT_TRUE(again.build());
  ASSERT_EQ(again.skin->grid()->anchors().anchors().size(),
            skin.grid()->anchors().anchors().size());
  test::forEachPoint(skin.grid()->layout(), [&](int, int, std::size_t k) {
    EXPECT_EQ(test::at(skin.restPosition(), k), test::at(again.skin->restPosition(), k));
    EXPECT_NEAR(skin.points().tissueRestLength[k], again.skin->points().tissueRestLength[k], 1e-6);
  });
}

}  // namespace
}  // namespace fascia
