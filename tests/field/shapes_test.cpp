#include <gtest/gtest.h>

#include <cmath>

#include "solids.h"

namespace fascia {
namespace {

TEST(Volume, OfARoundSuperellipsoidIsTheEllipsoids) {
  const Solid solid = makeSolid({"superellipsoid", {0.1, 0.2, 0.3, 1, 1}, {}});
  EXPECT_NEAR(solid.volume_m3(), 4.0 / 3.0 * kPi * 0.1 * 0.2 * 0.3, 1e-15);
}

TEST(Volume, OfAnOctahedronIsFourThirdsOfTheProduct) {
  const Solid solid = makeSolid({"superellipsoid", {0.1, 0.2, 0.3, 2, 2}, {}});
  EXPECT_NEAR(solid.volume_m3(), 4.0 / 3.0 * 0.1 * 0.2 * 0.3, 1e-15);
}

TEST(Volume, EqualsTheTessellationsByTheDivergenceTheorem) {
  for (const SolidDef& def : assortedSolids()) {
    if (!def.deformations.empty()) continue;
    const Solid solid = makeSolid(def);
    const double volume = solid.volume_m3();
    const double coarse = std::abs(enclosedVolume(solid.tessellate(64)) - volume);
    const double fine = std::abs(enclosedVolume(solid.tessellate(512)) - volume);
    EXPECT_LT(fine, 1e-3 * volume) << def.shape;
    EXPECT_LT(fine, 0.2 * coarse + 1e-6 * volume) << def.shape;
  }
}

// Taper scales a slice at z by f(z)²: over an even shape the mean of f² = 1 + a² <z²>/h².
TEST(Volume, OfATaperedSphereIsKnown) {
  const Solid solid = makeSolid({"sphere", {0.1}, {{"taper", {0.5}}}});
  const double sphere = 4.0 / 3.0 * kPi * 1e-3;
  EXPECT_NEAR(solid.volume_m3(), sphere * (1 + 0.25 / 5), 2e-3 * sphere);
}

TEST(Volume, IsKeptByTwistAndByBend) {  // twist: det J = 1; bend: the mean of 1 - k x is 1
  for (const char* type : {"twist", "bend"}) {
    const SolidDef plain{"superellipsoid", {0.04, 0.06, 0.2, 0.7, 0.9}, {}};
    SolidDef deformed = plain;
    deformed.deformations = {{type, {1.1}}};
    EXPECT_NEAR(makeSolid(deformed).volume_m3() / makeSolid(plain).volume_m3(), 1, 5e-3) << type;
  }
}

TEST(Tessellation, LiesOnTheSurfaceWithOutwardUnitNormals) {
  for (const SolidDef& def : assortedSolids()) {
    const Solid solid = makeSolid(def);
    const TriangleMesh mesh = solid.tessellate(24);
    ASSERT_EQ(mesh.positions.size(), mesh.normals.size());
    ASSERT_EQ(mesh.positions.size(), mesh.uvs.size());
    EXPECT_GT(enclosedVolume(mesh), 0);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const Sample sample = evaluateOne(solid, mesh.positions[i].cast<double>());
      EXPECT_NEAR(sample.distance_m, 0, 1e-6) << def.shape << " " << i;
      EXPECT_NEAR(mesh.normals[i].norm(), 1, 1e-5f);
    }
  }
}

TEST(Bounds, EncloseTheSurfaceTightly) {
  for (const SolidDef& def : assortedSolids()) {
    const Solid solid = makeSolid(def);
    Box surface;
    for (const auto& p : solid.tessellate(64).positions) surface.add(p.cast<double>());
    EXPECT_TRUE((surface.low.array() >= solid.bounds().low.array() - 1e-7).all()) << def.shape;
    EXPECT_TRUE((surface.high.array() <= solid.bounds().high.array() + 1e-7).all()) << def.shape;
    EXPECT_LT(solid.bounds().size().norm(), 2 * surface.size().norm()) << def.shape;
  }
}

TEST(Material, RoundTripsInsideAndOutside) {
  Random random(11);
  for (const SolidDef& def : assortedSolids()) {
    const Solid solid = makeSolid(def);
    for (int i = 0; i < 100; ++i) {
      const Vec3 x = random.uniform(0, 0.15) * randomDirection(random);
      const Vec3 local = solid.deformedFromShape(x);
      const Vec3 back = solid.localFromMaterial(solid.materialFromLocal(local));
      EXPECT_LT((back - local).norm(), 1e-12) << def.shape;
    }
  }
}

TEST(Material, StaysOnTheSurfaceWhileEveryParameterChanges) {
  Random random(12);
  for (const SolidDef& def : assortedSolids()) {
    Solid solid = makeSolid(def);
    std::vector<Vec3> anchors;
    for (const auto& p : solid.tessellate(12).positions) {
      anchors.push_back(solid.materialFromLocal(p.cast<double>()));
    }
    for (std::size_t k = 0; k < solid.parameterCount(); ++k) {
      const int index = static_cast<int>(k);
      const double before = solid.parameter(index);
      const double change = 0.05 * random.uniform(0.5, 1);
      const bool fits = before + change <= solid.parameterInfo(index).max;
      solid.setParameter(index, fits ? before + change : before - change);
      EXPECT_NE(solid.parameter(index), before);
    }
    for (const Vec3& anchor : anchors) {
      EXPECT_NEAR(evaluateOne(solid, solid.localFromMaterial(anchor)).distance_m, 0, 2e-6)
          << def.shape;
    }
  }
}

TEST(Solid, ReportsEveryFaultWithItsPointer) {
  Diagnostics diagnostics;
  const SolidDef def{"spere", {}, {{"taper", {7}}, {"blend", {}}, {"twist", {NAN}}}};
  const Solid solid(def, "/solids/3", diagnostics);
  ASSERT_EQ(diagnostics.errors().size(), 4u);
  EXPECT_EQ(diagnostics.errors()[0].where.pointer, "/solids/3/shape");
  EXPECT_NE(diagnostics.errors()[0].hint.find("sphere"), std::string::npos);
  EXPECT_EQ(diagnostics.errors()[1].where.pointer, "/solids/3/deformations/0/amount");
  EXPECT_EQ(diagnostics.errors()[2].where.pointer, "/solids/3/deformations/1/type");
  EXPECT_EQ(diagnostics.errors()[3].where.pointer, "/solids/3/deformations/2/angle_rad");
}

TEST(Solid, RefusesTooManyDeformationsAndParameters) {
  Diagnostics diagnostics;
  SolidDef def{"sphere", {0.1, 0.2}, {}};
  def.deformations.assign(kMaxDeformations + 1, {"taper", {0.1}});
  const Solid solid(def, "", diagnostics);
  EXPECT_EQ(diagnostics.errors().size(), 2u);
}

TEST(Solid, NamesParametersByPath) {
  const SolidDef def{"sphere", {}, {{"taper", {0.1}}, {"bend", {0.2}}, {"taper", {0.3}}}};
  Solid solid = makeSolid(def);
  ASSERT_EQ(solid.parameterCount(), 4u);
  EXPECT_EQ(solid.parameter(solid.parameterIndex("taper.amount")), 0.1);
  EXPECT_EQ(solid.parameter(solid.parameterIndex("bend.angle_rad")), 0.2);
  EXPECT_EQ(solid.parameter(solid.parameterIndex("taper2.amount")), 0.3);
  EXPECT_EQ(solid.parameterIndex("radius"), -1);
}

TEST(Solid, ClampsParametersAndIgnoresNaN) {
  Solid solid = makeSolid({"sphere", {0.1}, {}});
  solid.setParameter(0, 1e9);
  EXPECT_EQ(solid.parameter(0), solid.parameterInfo(0).max);
  solid.setParameter(0, NAN);
  EXPECT_EQ(solid.parameter(0), solid.parameterInfo(0).max);
}

}  // namespace
}  // namespace fascia
