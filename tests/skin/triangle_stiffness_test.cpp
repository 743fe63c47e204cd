#include <gtest/gtest.h>

#include <algorithm>

#include <Eigen/SparseCore>

#include "meshes.h"

namespace fascia {
namespace {

using test::MeshSheet, test::pointOf;

// Explicit steps need λmax(K⁻¹ J) ≤ 1 with K the bound of every point and J = −∂f/∂r.
double scaledStiffness(const TriangleMembrane& membrane, const VectorArray& r, std::size_t count) {
  std::vector<Eigen::Triplet<double>> entries;
  membrane.addForceJacobian(r, false, entries);
  const auto n = static_cast<Eigen::Index>(3 * count);
  Eigen::VectorXd scale(n), v(n);
  for (std::size_t k = 0; k < count; ++k)
    scale.segment<3>(static_cast<Eigen::Index>(3 * k))
        .setConstant(1 / std::sqrt(double{membrane.stiffnessBound()[k]}));
  Eigen::SparseMatrix<double> jacobian(n, n);
  jacobian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> scaled = -(scale.asDiagonal() * jacobian * scale.asDiagonal());
  // Power iteration, shifted so that buckling directions do not compete.
  for (Eigen::Index i = 0; i < n; ++i) v[i] = std::sin(1.7 * static_cast<double>(i) + 0.3);
  double value = 0;
  for (int i = 0; i < 300; ++i) {
    v = scaled * v + 0.5 * v;
    value = v.norm();
    v /= value;
  }
  return value - 0.5;
}

// The way from rest to r as far as no material direction is longer than the plateau allows.
VectorArray withinPlateau(const MeshSheet& sheet, const TriangleMembrane& membrane, VectorArray r) {
  const auto isWithin = [&](const TriangleMembrane::Triangle& t) {
    const Vec3 origin = pointOf(r, t.corners[0]);
    const Vec3 e1 = pointOf(r, t.corners[1]) - origin, e2 = pointOf(r, t.corners[2]) - origin;
    const Vec3 xu = t.u[0] * e1 + t.u[1] * e2, xv = t.v[0] * e1 + t.v[1] * e2;
    return std::max(xu.squaredNorm(), xv.squaredNorm()) < 1 + membrane.cap();
  };
  while (!std::all_of(membrane.triangles().begin(), membrane.triangles().end(), isWithin))
    for (std::size_t k = 0; k < sheet.count(); ++k)
      test::putPoint(r, k, 0.1 * pointOf(sheet.rest, k) + 0.9 * pointOf(r, k));
  return r;
}

TEST(TriangleStiffnessBound, HoldsForEveryPostureUpToThePlateau) {
  Random random(39);
  double largest = 0;
  for (const double maxStretch : {1.25, 1.4, 3.0}) {
    for (const double bending : {0.0, 0.2, 2.0}) {
      if (bending > 0 && maxStretch > 2) continue;  // edges grow far beyond their rest length
      MeshSheet sheet = test::unevenSheet(13, 9, random);
      sheet.material.max_stretch = static_cast<float>(maxStretch);
      sheet.setBending(bending);
      const TriangleMembrane membrane = sheet.membrane();
      const auto examine = [&](const VectorArray& r) {
        const VectorArray posture = withinPlateau(sheet, membrane, r);
        const double share = scaledStiffness(membrane, posture, sheet.count());
        EXPECT_LE(share, 1) << maxStretch << ", " << bending;
        largest = std::max(largest, share);
      };
      for (const double amplitude : {0.0, 0.1, 0.3, 0.6, 1.5})
        examine(sheet.scattered(amplitude, random));
      const double s = maxStretch / 1.1;
      examine(sheet.mapped([&](const Vec3& p) { return Vec3(s * p); }));
      examine(sheet.mapped([&](const Vec3& p) { return Vec3(s * (p.x() + p.y()), 0, 0); }));
      examine(sheet.mapped(
          [&](const Vec3& p) { return Vec3(s * (p.x() + 0.7 * p.y()), 0.7 * s * p.y(), 0); }));
      for (const double crease : {0.35, 0.6})  // folded onto itself
        examine(sheet.mapped([&](const Vec3& p) {
          return p.x() < crease ? p : Vec3(2 * crease - p.x(), p.y(), p.z());
        }));
      examine(sheet.mapped([](const Vec3& p) {
        return Vec3(0.1 * std::sin(p.x() / 0.1), p.y(), 0.1 * std::cos(p.x() / 0.1));
      }));
    }
  }
  EXPECT_GT(largest, 0.5);
  RecordProperty("largest_share", std::to_string(largest));
}

// A bound that is too large adds mass that the skin does not need.
TEST(TriangleStiffnessBound, IsAtRestAtMostThreeTimesTheStiffness) {
  for (const double shear : {0.0, 60.0}) {
    MeshSheet sheet(21, 21, 1, 1);
    sheet.setMaterial(150, 150, shear);
    sheet.setDirection(Vec3::UnitX());
    EXPECT_GT(scaledStiffness(sheet.membrane(), sheet.rest, sheet.count()), 1 / 3.0) << shear;
  }
}

}  // namespace
}  // namespace fascia
