#include <gtest/gtest.h>

#include <Eigen/LU>

#include <fascia/deformable/body/body_field.h>
#include <fascia/geometry/box_tree.h>

#include "bodies.h"

namespace fascia {
namespace {

const Vec3 kHalf_m{0.2, 0.05, 0.05};  // of the ellipsoid inside of the bar

Solid ellipsoid() {
  Diagnostics diagnostics;
  const Solid solid({"superellipsoid", {kHalf_m.x(), kHalf_m.y(), kHalf_m.z(), 1, 1}, {}}, "",
                    diagnostics);
  return solid;
}

struct OneBody {
  BodyModel model;
  OdeState state;
  BodyField field;

  explicit OneBody(const BasisPtr& basis,
                   BodySurfacePtr surface = makeSolidSurface(ellipsoid(), 16)) {
    model.add(test::makeBar(basis));
    state = model.restState();
    field = BodyField(model, std::vector<BodySurfacePtr>{std::move(surface)});
  }
  void update() { field.update(state.r, state.v); }
  // A bar bent around z into an arc of the given angle, its ends thinned, as well as the basis can:
  // the shapes are fitted to it at points all over the bar.
  void bend(double angle_rad, const Transform& place) {
    const BodyShape& shape = model.shape(BodyId(0));
    const double radius_m = test::kBarSize_m.x() / angle_rad;
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, shape.shapeCount());
    const Quadrature points = boxQuadrature(3, test::boxOf(test::kBarSize_m), 12);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& X = points.points_m[i];
      const double turn = X.x() / radius_m, out_m = radius_m - X.y();
      const Vec3 bent(out_m * std::sin(turn), radius_m - out_m * std::cos(turn), X.z());
      sum += 1000 * points.weights[i] * place.point(bent) * shape.pointWeights(X).transpose();
    }
    Eigen::Map<Eigen::MatrixXd>(state.r.data(), 3, shape.shapeCount()) = sum;
    update();
  }
};

struct FieldValue {
  double distance_m;
  Vec3 normal;
};

FieldValue valueAt(const Field& field, const Vec3& p) {
  const Eigen::Vector3f x = p.cast<float>();
  float d = 0, nx = 0, ny = 0, nz = 0;
  field.evaluate(SolidId(0), {&x.x(), &x.y(), &x.z(), 1}, &d, {&nx, &ny, &nz, 1});
  return {d, Vec3(nx, ny, nz)};
}

Vec3 velocityAt(const Field& field, const Vec3& p) {
  const Eigen::Vector3f x = p.cast<float>();
  Eigen::Vector3f v;
  field.velocity(SolidId(0), {&x.x(), &x.y(), &x.z(), 1}, {&v.x(), &v.y(), &v.z(), 1});
  return v.cast<double>();
}

Vec3 randomIn(Random& random, const Vec3& half) {
  return half.cwiseProduct(
      Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
}

Transform somePlace() {
  return {Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix(),
          Vec3(0.5, -1, 0.25)};
}

Mat3 someStretch() {
  Mat3 F;
  F << 1.3, 0.2, -0.1, 0.05, 0.8, 0.3, -0.2, 0.1, 1.1;
  return F;
}

std::vector<BasisPtr> curvedBases() {
  const Box box = test::boxOf(test::kBarSize_m);
  return {makePolynomialBasis(3, 2, box), makePolynomialBasis(3, 4, box),
          makeBernsteinBasis(3, {3, 1, 1}, box)};
}

TEST(BodyField, AffineEllipsoidHasItsExactSurfaceAndNormals) {
  OneBody body(makeAffineBasis(3));
  const Mat3 F = someStretch();
  Eigen::MatrixXd R(3, 4);
  R << F, Vec3(0.3, 0.1, -0.2);
  body.model.shape(BodyId(0)).setShapeMatrix(R, body.state.r);
  body.update();
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Vec3 u = randomIn(random, Vec3::Ones()).normalized();
    const Vec3 x = F * kHalf_m.cwiseProduct(u) + R.col(3);
    const FieldValue value = valueAt(body.field, x);
    EXPECT_NEAR(value.distance_m, 0, 1e-6);
    const Vec3 normal =
        (F.inverse().transpose() * u.cwiseQuotient(kHalf_m)).normalized();  // of |A x| = 1
    EXPECT_LT((value.normal - normal).norm(), 1e-4);
  }
}

TEST(BodyField, DistanceGrowsAlongItsNormal) {
  OneBody body(makePolynomialBasis(3, 2, test::boxOf(test::kBarSize_m)));
  body.bend(1.0, somePlace());
  Random random(4);
  int checked = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 u = randomIn(random, Vec3::Ones()).normalized();
    const Vec3 x = body.field.worldFromMaterial(SolidId(0), kHalf_m.cwiseProduct(u));
    const Vec3 n = valueAt(body.field, x).normal;
    EXPECT_NEAR(valueAt(body.field, x).distance_m, 0, 2e-6);
    const double h_m = 2e-3;
    const double slope = (valueAt(body.field, x + h_m * n).distance_m -
                          valueAt(body.field, x - h_m * n).distance_m) /
                         (2 * h_m);
    EXPECT_NEAR(slope, 1, 0.02);
    ++checked;
  }
  EXPECT_EQ(checked, 300);
}

TEST(BodyField, RigidMotionLeavesDistancesUnchanged) {
  for (const BasisPtr& basis : test::allBases()) {
    if (basis->dimension() == 2) continue;
    OneBody body(basis);
    const BodyField before = body.field;
    const Transform place = somePlace();
    body.model.place(BodyId(0), place, body.state);
    body.update();
    Random random(6);
    for (int i = 0; i < 100; ++i) {
      const Vec3 X = randomIn(random, 1.4 * kHalf_m);
      const FieldValue rest = valueAt(before, X), moved = valueAt(body.field, place.point(X));
      EXPECT_NEAR(moved.distance_m, rest.distance_m, 2e-6) << basis->name();
    }
    EXPECT_LT((body.field.frame(SolidId(0)).rotation - place.rotation).norm(), 1e-9);
    for (std::size_t c = 0; c < Field::kOutline; ++c)
      EXPECT_LT((body.field.outline(SolidId(0))[c] - before.outline(SolidId(0))[c]).norm(), 1e-9);
  }
}

TEST(BodyField, InverseMapFindsPointsOfMuchBentBodies) {
  for (const BasisPtr& basis : curvedBases()) {
    for (const double angle_rad : {0.5, 1.5, 2.2}) {
      OneBody body(basis);
      body.bend(angle_rad, somePlace());
      const Vec3 X0(0.2, 0, 0);
      const Vec3 straight = somePlace().point(X0);
      EXPECT_GT((body.field.worldFromMaterial(SolidId(0), X0) - straight).norm(),
                0.2 * angle_rad * test::kBarSize_m.x() / 2);  // it is bent
      Random random(7);
      for (int i = 0; i < 200; ++i) {
        const Vec3 X = randomIn(random, kHalf_m);
        const Vec3 x = body.field.worldFromMaterial(SolidId(0), X);
        EXPECT_LT((body.field.materialFromWorld(SolidId(0), x) - X).norm(),
                  1e-6 * test::kBarSize_m.x())
            << basis->name() << " " << angle_rad;
      }
    }
  }
}

TEST(BodyField, BoundsHoldTheSurfaceAndFarPointsAreNeverTooFar) {
  for (const BasisPtr& basis : curvedBases()) {
    OneBody body(basis);
    body.bend(2.0, somePlace());
    const Box bounds = body.field.bounds(SolidId(0));
    TriangleMesh mesh;
    body.field.writeMesh(SolidId(0), mesh);
    for (const Eigen::Vector3f& p : mesh.positions)
      EXPECT_TRUE(meets({p.cast<double>(), p.cast<double>()}, bounds)) << basis->name();
    Random random(8);
    for (int i = 0; i < 100; ++i) {
      const Vec3 x = bounds.center() + 3 * randomIn(random, bounds.size());
      if (meets({x, x}, bounds)) continue;
      double nearest_m = 1e300;
      for (const Eigen::Vector3f& p : mesh.positions)
        nearest_m = std::min(nearest_m, (p.cast<double>() - x).norm());
      const double found_m = valueAt(body.field, x).distance_m;
      EXPECT_GE(found_m, 0);
      EXPECT_LE(found_m, 1.2 * nearest_m) << basis->name();
    }
  }
}

TEST(BodyField, VelocityIsTheDerivativeOfWhereTheMatterIs) {
  for (const BasisPtr& basis : test::allBases()) {
    if (basis->dimension() == 2) continue;
    OneBody body(basis);
    Random random(9);
    const Eigen::VectorXd q = test::deformed(body.model.shape(BodyId(0)), 0.01, 10);
    for (std::size_t i = 0; i < body.state.r.size(); ++i) {
      body.state.r[i] = q[static_cast<Eigen::Index>(i)];
      body.state.v[i] = random.uniform(-0.1, 0.1);
    }
    body.update();
    const double h_s = 1e-5;
    OneBody ahead(basis), behind(basis);
    for (std::size_t i = 0; i < body.state.r.size(); ++i) {
      ahead.state.r[i] = body.state.r[i] + h_s * body.state.v[i];
      behind.state.r[i] = body.state.r[i] - h_s * body.state.v[i];
    }
    ahead.update(), behind.update();
    for (int i = 0; i < 50; ++i) {
      const Vec3 X = randomIn(random, kHalf_m);
      const Vec3 measured = (ahead.field.worldFromMaterial(SolidId(0), X) -
                             behind.field.worldFromMaterial(SolidId(0), X)) /
                            (2 * h_s);
      ASSERT_GT(measured.norm(), 1e-3);
      const Vec3 x = body.field.worldFromMaterial(SolidId(0), X);
      EXPECT_LT((velocityAt(body.field, x) - measured).norm(), 1e-4 * (1 + measured.norm()))
          << basis->name();
    }
  }
}

TEST(BodyField, FlatBodiesArePlates) {
  const Box box = test::boxOf(test::kBarSize_m);
  const std::vector<Vec2> outline{{-0.2, -0.05}, {0.2, -0.05}, {0.2, 0.05}, {-0.2, 0.05}};
  for (const BasisPtr& basis : {makeAffineBasis(2), makePolynomialBasis(2, 2, box)}) {
    OneBody body(basis, makeOutlineSurface(outline, 0.06));
    const Transform place{Eigen::AngleAxisd(0.6, Vec3::UnitZ()).toRotationMatrix(), Vec3(1, 2, 0)};
    body.model.place(BodyId(0), place, body.state);
    body.update();
    const FieldValue above = valueAt(body.field, place.point(Vec3(0.1, 0.02, 0.05)));
    EXPECT_NEAR(above.distance_m, 0.02, 1e-6);
    EXPECT_LT((above.normal - Vec3::UnitZ()).norm(), 1e-5);
    EXPECT_NEAR(valueAt(body.field, place.point(Vec3(0.25, 0.02, 0.01))).distance_m, 0.05, 1e-6);
    EXPECT_LT((body.field.materialFromWorld(SolidId(0), place.point(Vec3(0.1, 0, 0.02))) -
               Vec3(0.1, 0, 0.02))
                  .norm(),
              1e-7);
  }
}

TEST(BodyField, BatchesEqualSinglePoints) {
  OneBody body(makePolynomialBasis(3, 2, test::boxOf(test::kBarSize_m)));
  body.bend(1.2, somePlace());
  Random random(11);
  constexpr std::size_t kCount = 131;
  VectorArray points(kCount), normals(kCount), world(kCount);
  FloatArray distance_m(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    const Vec3 x = body.field.worldFromMaterial(SolidId(0), randomIn(random, 1.5 * kHalf_m));
    points.x[i] = float(x.x()), points.y[i] = float(x.y()), points.z[i] = float(x.z());
  }
  body.field.evaluate(SolidId(0), view(points, 0, kCount), distance_m.data(),
                      view(normals, 0, kCount));
  for (std::size_t i = 0; i < kCount; ++i) {
    const FieldValue one = valueAt(body.field, Vec3(points.x[i], points.y[i], points.z[i]));
    EXPECT_EQ(float(one.distance_m), distance_m[i]);
    EXPECT_EQ(float(one.normal.y()), normals.y[i]);
  }
}

}  // namespace
}  // namespace fascia
