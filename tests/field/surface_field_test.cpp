#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/field/solid.h>
#include <fascia/field/surface_field.h>

namespace fascia {
namespace {

constexpr double kRadius_m = 0.5;

TriangleMesh sphere() {
  Diagnostics diagnostics;
  const Solid solid({"sphere", {kRadius_m}, {}}, "", diagnostics);
  diagnostics.throwIfErrors();
  return solid.tessellate(64);
}

float distanceAt(const SurfaceField& field, const Vec3& p) {
  const Eigen::Vector3f at = p.cast<float>();
  float distance_m, x, y, z;
  field.evaluate(SolidId(0), {&at.x(), &at.y(), &at.z(), 1}, &distance_m, {&x, &y, &z, 1});
  return distance_m;
}

TEST(SurfaceField, DistancesOfASphereAreItsOwnWhicheverWayItsTrianglesTurn) {
  TriangleMesh mesh = sphere();
  for (int turn = 0; turn < 2; ++turn) {
    const SurfaceField field(mesh, std::vector<float>(mesh.positions.size(), 0.1f));
    for (const Vec3& p : {Vec3(0.7, 0.1, -0.2), Vec3(0.1, 0.3, 0.2), Vec3(0, -2, 0.3)})
      EXPECT_NEAR(distanceAt(field, p), p.norm() - kRadius_m, 3e-3);
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
}

TEST(SurfaceField, MovesWithItsVerticesAndTellsTheirVelocity) {
  const TriangleMesh mesh = sphere();
  std::vector<float> depth_m(mesh.positions.size());
  for (std::size_t v = 0; v < depth_m.size(); ++v) depth_m[v] = mesh.positions[v].x() > 0 ? 1 : 2;
  SurfaceField field(mesh, depth_m);
  std::vector<Eigen::Vector3f> moved = mesh.positions;
  for (Eigen::Vector3f& p : moved) p.x() += 1;
  field.update(moved, mesh.positions, 0.5);
  EXPECT_NEAR(distanceAt(field, Vec3(2, 0, 0)), 1 - kRadius_m, 3e-3);
  const Eigen::Vector3f at(1.6f, 0, 0);
  float x, y, z, depth;
  field.velocity(SolidId(0), {&at.x(), &at.y(), &at.z(), 1}, {&x, &y, &z, 1});
  EXPECT_NEAR(x, 2, 1e-4);
  field.softness({&at.x(), &at.y(), &at.z(), 1}, &depth);
  EXPECT_NEAR(depth, 1, 1e-5);
  const Vec3 material = field.materialFromWorld(SolidId(0), Vec3(1.6, 0.1, 0));
  EXPECT_LT((field.worldFromMaterial(SolidId(0), material) - Vec3(1 + 0.493, 0.082, 0)).norm(),
            5e-3);
}

// Half a sphere has no inside beyond its rim.
TEST(SurfaceField, NothingIsInsideBeyondABorder) {
  TriangleMesh mesh = sphere();
  std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.positions[t[0]].y() > 0.2; });
  const SurfaceField field(mesh, std::vector<float>(mesh.positions.size(), 0.1f));
  EXPECT_GT(distanceAt(field, Vec3(0, 0.8, 0)), 0);
  EXPECT_LT(distanceAt(field, Vec3(0, -0.4, 0)), 0);
}

}  // namespace
}  // namespace fascia
