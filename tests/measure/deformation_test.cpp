#include <gtest/gtest.h>

#include <numeric>

#include <fascia/measure/deformation.h>

#include "shapes.h"

namespace fascia {
namespace {

using Points = std::vector<Eigen::Vector3f>;

Transform someMotion() {
  return {Eigen::AngleAxisd(0.8, Vec3(1, 2, -0.5).normalized()).toRotationMatrix(), {0.3, -2, 1}};
}

Points moved(const Points& points, const Transform& motion) {
  Points out;
  for (const Eigen::Vector3f& p : points)
    out.push_back(motion.point(p.cast<double>()).cast<float>());
  return out;
}

TEST(EdgeStretch, IsOneForARigidMotion) {
  const TriangleMesh mesh = tube(0.5, 2, 20, 30);
  const EdgeStretch s =
      edgeStretch(mesh.triangles, mesh.positions, moved(mesh.positions, someMotion()));
  EXPECT_NEAR(s.largest, 1, 1e-4);
  EXPECT_NEAR(s.percentile99, 1, 1e-5);
}

TEST(EdgeStretch, FindsTheOneEdgeThatGrewAndThePercentileThatDidNot) {
  TriangleMesh mesh = tube(0.5, 2, 20, 30);
  Points longer = mesh.positions;
  // The first ring moves out by as much as the rings are apart: edges along x double.
  for (std::size_t p = 0; p < 20; ++p) longer[p].x() -= static_cast<float>(2.0 / 29);
  const EdgeStretch s = edgeStretch(mesh.triangles, mesh.positions, longer);
  EXPECT_NEAR(s.largest, 2, 1e-5);
  // 40 of 20 · (30 + 2 · 29) edges are longer: 2.3 %, so that the percentile is among them, and
  // equal to the diagonals' stretch or the straight edges'.
  EXPECT_GT(s.percentile99, 1.1);
  Points onePoint = mesh.positions;
  onePoint[0].x() -= 1;
  EXPECT_NEAR(edgeStretch(mesh.triangles, mesh.positions, onePoint).percentile99, 1, 1e-6);
}

TEST(SurfaceVolume, OfABoxIsExactWhereverItLies) {
  TriangleMesh mesh;
  addBox(mesh, {0, 0, 0}, {1, 2, 3});
  const SurfaceVolume v = surfaceVolume(mesh.triangles, moved(mesh.positions, someMotion()));
  EXPECT_NEAR(v.counted_m3, 6, 1e-5);
  EXPECT_EQ(v.repeated_m3, 0);
}

TEST(SurfaceVolume, ClosesATubeByItsRims) {
  const TriangleMesh mesh = tube(0.3, 2, 32, 9);
  const Points points = moved(mesh.positions, someMotion());
  EXPECT_NEAR(surfaceVolume(mesh.triangles, points).occupied_m3(), 2 * ringArea(0.3, 32), 1e-6);
}

TEST(SurfaceVolume, CountsSharedSpaceOnce) {
  TriangleMesh mesh;
  addBox(mesh, {0, 0, 0}, {1, 1, 1});
  addBox(mesh, {0.5, 0.5, 0.5}, {1.5, 1.5, 1.5});
  const SurfaceVolume v = surfaceVolume(mesh.triangles, mesh.positions);
  EXPECT_NEAR(v.counted_m3, 2, 1e-6);
  EXPECT_NEAR(v.repeated_m3, 0.125, 0.125 * 0.02);
  const SurfaceVolume turned = surfaceVolume(mesh.triangles, moved(mesh.positions, someMotion()));
  EXPECT_NEAR(turned.repeated_m3, 0.125, 0.125 * 0.02);
}

TEST(SurfaceVolume, InsideOutOccupiesNothing) {
  TriangleMesh mesh;
  addBox(mesh, {0, 0, 0}, {1, 1, 1});
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const SurfaceVolume v = surfaceVolume(mesh.triangles, mesh.positions);
  EXPECT_NEAR(v.counted_m3, -1, 1e-6);
  EXPECT_NEAR(v.occupied_m3(), 0, 0.02);
}

TEST(JointVolumeLoss, IsZeroForARigidMotion) {
  const TriangleMesh mesh = tube(0.3, 2, 32, 9);
  const std::span near = std::span(mesh.triangles).subspan(2 * 32 * 2, 2 * 32 * 4);
  EXPECT_NEAR(
      jointVolumeLoss(mesh.triangles, near, mesh.positions, moved(mesh.positions, someMotion())), 0,
      1e-5);
}

// A tube of nine rings whose middle ring shrinks to a point, as a joint does that is twisted by
// 180° under linear blending: the two slices beside it become cones, two thirds of them are lost.
TEST(JointVolumeLoss, OfACollapsedRingIsTheConesComplement) {
  const TriangleMesh mesh = tube(0.3, 2, 32, 9);
  const std::span near = std::span(mesh.triangles).subspan(2 * 32 * 2, 2 * 32 * 4);  // x in [½, 1½]
  Points collapsed = mesh.positions;
  for (std::size_t p = 4 * 32; p < 5 * 32; ++p) collapsed[p] = {1, 0, 0};
  // Two slices of the four near the joint lose two thirds.
  EXPECT_NEAR(jointVolumeLoss(mesh.triangles, near, mesh.positions, collapsed), 1.0 / 3, 1e-5);
}

TEST(SkinSlide, SeesWhatMovesAlongTheSurfaceOnly) {
  const Points rest = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const Points normals(3, {0, 0, 1});
  const Transform motion = someMotion();
  const std::vector<std::uint32_t> bone = {1, 1, 1}, which = {0, 1};
  const std::vector<Transform> motions = {Transform{}, motion};
  // The first is lifted off, the second shifted by a 3-4-5 triangle and lifted; the third is not
  // asked for.
  Points now = {{0, 0, 0.5f}, {1.03f, 0.04f, 0.7f}, {9, 9, 9}};
  now = moved(now, motion);
  const SkinSlide slide = skinSlide(which, rest, normals, {bone, motions}, now);
  EXPECT_NEAR(slide.largest_m, 0.05, 1e-6);
  EXPECT_NEAR(slide.rms_m, 0.05 / std::sqrt(2.0), 1e-6);
}

std::vector<Points> vibration(double amplitude_m, double frequency_hz, const Transform& turn) {
  std::vector<Points> frames;
  for (int f = 0; f < 240; ++f) {
    const double value = amplitude_m * std::sin(2 * kPi * frequency_hz * f / 60 + 0.3);
    frames.push_back(
        moved({{static_cast<float>(value), 1, 2}, {0, static_cast<float>(value), 0}}, turn));
  }
  return frames;
}

TEST(Jitter, HasTheGainOfAThirdDifference) {
  const double rms = 0.01 / std::sqrt(2.0);
  for (const double frequency_hz : {2.0, 10.0, 25.0}) {
    const double gain = std::pow(2 * std::sin(kPi * frequency_hz / 60), 3);
    const double jitter = jitter_m(vibration(0.01, frequency_hz, {}));
    EXPECT_NEAR(jitter / (gain * rms), 1, 0.02) << frequency_hz;
  }
}

TEST(Jitter, OfPointsThatRideOnTheirBoneIsNothing) {
  const std::vector<std::uint32_t> bone = {0, 0};
  std::vector<Points> seen(20);
  const Points rest = {{0.1f, 0.2f, 0.3f}, {1, 0, 0}};
  for (std::size_t f = 0; f < seen.size(); ++f) {
    const double angle = 0.5 * std::pow(-1.0, static_cast<double>(f));  // a shaking bone
    const std::vector<Transform> motion = {
        {Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix(), {angle, 0, 0}}};
    intoBones({bone, motion}, moved(rest, motion[0]), seen[f]);
    EXPECT_LT((seen[f][1] - rest[1]).norm(), 1e-5);
  }
  EXPECT_LT(jitter_m(seen), 1e-5);
  EXPECT_EQ(jitter_m(std::span(seen).first(3)), 0);
}

}  // namespace
}  // namespace fascia
