#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "body.h"

namespace fascia {
namespace {

using test::Body;

std::vector<std::string> pointers(Body& body) {
  body.build("/skin");
  std::vector<std::string> found;
  for (const Issue& issue : body.diagnostics.errors()) {
    found.push_back(issue.where.pointer);
    EXPECT_NE(issue.message, "");
  }
  return found;
}

SkinPointsDef savedGrid(int columns, int rows) {
  SkinPointsDef points;
  points.columns = columns, points.rows = rows;
  return points;
}

struct Fault {
  std::string pointer;
  std::function<void(SkinDef&)> make;
};

std::vector<Fault> faults() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {
      {"/skin/grid/0", [](SkinDef& d) { d.grid.columns = 7; }},
      {"/skin/grid/0", [](SkinDef& d) { d.grid.columns = -5; }},
      {"/skin/grid/1", [](SkinDef& d) { d.grid.rows = 5000; }},
      {"/skin/bottom/joint", [](SkinDef& d) { d.grid.bottom.joint = "hippo"; }},
      {"/skin/top/joint", [](SkinDef& d) { d.grid.top.joint = ""; }},
      {"/skin/material/density_kg_per_m2", [](SkinDef& d) { d.material.density_kg_per_m2 = 0; }},
      {"/skin/material/stretch_u_N_per_m",
       [nan](SkinDef& d) { d.material.stretch_u_N_per_m = nan; }},
      {"/skin/material/stretch_v_N_per_m", [](SkinDef& d) { d.material.stretch_v_N_per_m = -1; }},
      {"/skin/material/shear_N_per_m", [](SkinDef& d) { d.material.shear_N_per_m = 2e6; }},
      {"/skin/material/bending_Nm", [](SkinDef& d) { d.material.bending_Nm = -1; }},
      {"/skin/material/drag_Ns_per_m3", [](SkinDef& d) { d.material.drag_Ns_per_m3 = 1e300; }},
      {"/skin/material/prestretch", [](SkinDef& d) { d.material.prestretch = 0; }},
      {"/skin/material/max_stretch", [](SkinDef& d) { d.material.max_stretch = 1; }},
      {"/skin/material/friction_per_s", [](SkinDef& d) { d.material.friction_per_s = -1; }},
      {"/skin/material/restitution", [](SkinDef& d) { d.material.restitution = 1.5; }},
      {"/skin/fat/thickness_m", [](SkinDef& d) { d.fat.thickness_m = -0.01; }},
      {"/skin/tissue/stiffness_N_per_m3", [](SkinDef& d) { d.tissue.stiffness_N_per_m3 = -1; }},
      {"/skin/tissue/damping_Ns_per_m3", [](SkinDef& d) { d.tissue.damping_Ns_per_m3 = 1e9; }},
      {"/skin/tissue/rest_length_m", [](SkinDef& d) { d.tissue.rest_length_m = -1; }},
      {"/skin/cling", [](SkinDef& d) { d.grid.cling = 2; }},
      {"/skin/regions/0/solid",
       [](SkinDef& d) {
         d.regions.resize(1);
         d.regions[0].solid = "tail";
       }},
      {"/skin/brushes/1/joint",
       [](SkinDef& d) {
         d.brushes.resize(2);
         d.brushes[1].joint = "knee";
       }},
      {"/skin/brushes/0/radius_m",
       [](SkinDef& d) {
         d.brushes.resize(1);
         d.brushes[0].radius_m = 0;
       }},
      {"/skin/anchors/0/solid",
       [](SkinDef& d) {
         d.grid.anchors = {{0.5, 0.5, "tail", Vec3::Zero()}};
       }},
      {"/skin/points/columns", [](SkinDef& d) { d.points = savedGrid(3, 8); }},
      {"/skin/points/fat_m",
       [](SkinDef& d) {
         d.points = savedGrid(8, 8);
         d.points->fat.edit().assign(63, 0.1f);
       }},
      {"/skin/points/density_kg_per_m2",
       [](SkinDef& d) {
         d.points = savedGrid(8, 8);
         d.points->density.edit().assign(64, std::numeric_limits<float>::quiet_NaN());
       }},
      {"/skin/points/anchor_solid",
       [](SkinDef& d) {
         d.points = savedGrid(8, 8);
         d.points->anchor_solid.edit().assign(64, 99);
         d.points->anchor.edit().resize(64);
       }},
      {"/skin/points/anchor",
       [](SkinDef& d) {
         d.points = savedGrid(8, 8);
         d.points->anchor_solid.edit().assign(64, 0);
       }},
      {"/skin/points",
       [](SkinDef& d) {
         d.points = savedGrid(8, 8);
         d.points->rest_position_m.edit().assign(64, {0, HUGE_VALF, 0});
       }},
  };
}

TEST(SkinFaults, AreNamedByTheirPointer) {
  for (const Fault& fault : faults()) {
    Body body;
    fault.make(body.skinDef);
    EXPECT_THAT(pointers(body), testing::Contains(fault.pointer));
  }
}

TEST(SkinFaults, AreReportedAllAtOnce) {
  Body body;
  body.skinDef.material.density_kg_per_m2 = -3;
  body.skinDef.grid.cling = 7;
  body.skinDef.fat.thickness_m = 3;
  EXPECT_THAT(pointers(body),
              testing::UnorderedElementsAre("/skin/material/density_kg_per_m2", "/skin/cling",
                                            "/skin/fat/thickness_m"));
}

TEST(SkinFaults, SuggestTheNameThatWasMeant) {
  Body body;
  body.skinDef.grid.top.joint = "nek";
  body.build();
  ASSERT_EQ(body.diagnostics.errors().size(), 1u);
  EXPECT_THAT(body.diagnostics.errors()[0].hint, testing::HasSubstr("neck"));
}

TEST(SkinFaults, IncludeASkinWithoutFlesh) {
  Body body;
  body.fleshDef.solids.clear();
  EXPECT_THAT(pointers(body), testing::ElementsAre("/skin"));
}

TEST(SkinFaults, AreNoneInADefaultSkin) {
  Body body;
  EXPECT_TRUE(body.build());
}

}  // namespace
}  // namespace fascia
