#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Eigenvalues>

#include <fascia/deformable/solve/body_stepper.h>

#include "bodies.h"

// Bodies of many functions have few energy points: what that costs, and the meshes they are of.

namespace fascia {
namespace {

constexpr BodyMaterial kFlesh{.rigidity_Pa = 2e4, .volume_Pa = 4e4};
constexpr double kRadius_m = 0.1, kHalfLength_m = 0.4, kDensity = 1000;

Box capsuleBox() {
  const Vec3 half(kRadius_m, kRadius_m, kHalfLength_m + kRadius_m);
  return {-half, half};
}

std::vector<BasisPtr> largeBases() {
  return {makeBernsteinBasis(3, {4, 2, 2}, capsuleBox()),
          makeBernsteinBasis(3, {3, 2, 2}, capsuleBox()), makePolynomialBasis(3, 4, capsuleBox())};
}

// The same body with its own energy points, and with all samples.
struct Pair {
  std::shared_ptr<const BodyShape> few, all;
  std::size_t points;
};

Pair capsules(const BasisPtr& basis, double cell_m) {
  Diagnostics diagnostics;
  const Solid solid({"capsule", {kRadius_m, kHalfLength_m}, {}}, "", diagnostics);
  Matter matter = solidMatter(solid, kDensity, cell_m, MatterDetail::of(*basis));
  Pair pair;
  pair.points = matter.volume.size();
  pair.few = std::make_shared<BodyShape>(BodyDef{basis, matter, kFlesh, Crushing::resisted});
  matter.volume = matter.mass;
  for (double& weight : matter.volume.weights) weight /= kDensity;
  pair.all = std::make_shared<BodyShape>(BodyDef{basis, matter, kFlesh, Crushing::resisted});
  return pair;
}

Eigen::VectorXd rest(const BodyShape& shape) {
  Eigen::VectorXd q(shape.coordinateCount());
  shape.setRest({}, test::view(q));
  return q;
}

// What random loads make of a body, of a root mean square strain of about `strain`.
std::vector<Eigen::VectorXd> underRandomLoads(const BodyShape& shape, double strain, int count) {
  const Eigen::Index n = shape.coordinateCount();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  shape.addStiffness(test::view(rest(shape)), 1, Curvature::exact, K);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(K);
  const double energy_J = strain * strain * 4 * kFlesh.rigidity_Pa * shape.volume_m3();
  Random random(99);
  std::vector<Eigen::VectorXd> found;
  for (int i = 0; i < count; ++i) {
    Eigen::VectorXd answer = Eigen::VectorXd::Zero(n);
    for (Eigen::Index mode = 6; mode < n; ++mode)  // the first move it rigidly
      answer += random.uniform(-1, 1) / modes.eigenvalues()[mode] * modes.eigenvectors().col(mode);
    answer *= std::sqrt(2 * energy_J / answer.dot(K * answer));
    found.push_back(rest(shape) + answer);
  }
  return found;
}

TEST(FittedQuadrature, IsAFewPointsWithPositiveWeightsAndTheWholeVolume) {
  for (const BasisPtr& basis : largeBases()) {
    const Pair pair = capsules(basis, 0.02);
    EXPECT_LT(pair.points, 320u) << basis->size();
    EXPECT_GT(pair.points, static_cast<std::size_t>(basis->size()));
    EXPECT_NEAR(pair.few->volume_m3(), pair.all->volume_m3(), 2e-3 * pair.all->volume_m3());
  }
}

TEST(FittedQuadrature, KeepsEnergyForceAndStiffnessWithinAPercent) {
  for (const BasisPtr& basis : largeBases()) {
    const auto [few, all, points] = capsules(basis, 0.0125);  // as fine as scenes
    for (const Eigen::VectorXd& q : underRandomLoads(*all, 0.1, 5)) {
      const Eigen::Index n = q.size();
      const double energy = all->energy(test::view(q));
      EXPECT_GT(energy, 1);
      EXPECT_NEAR(few->energy(test::view(q)), energy, 0.01 * energy) << basis->size();
      Eigen::VectorXd force[2] = {Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
      Eigen::MatrixXd K[2] = {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
      for (const int which : {0, 1}) {
        const BodyShape& shape = which == 0 ? *few : *all;
        shape.addElasticForce(test::view(q), test::view(force[which]));
        shape.addStiffness(test::view(q), 1, Curvature::exact, K[which]);
      }
      EXPECT_LT((force[0] - force[1]).norm(), 0.01 * force[1].norm()) << basis->size();
      EXPECT_LT((K[0] - K[1]).norm(), 0.01 * K[1].norm()) << basis->size();
    }
  }
}

// Held level by one end and let go: when it hangs.
double quarterPeriod_s(const std::shared_ptr<const BodyShape>& shape) {
  const Vec3 end(0, 0, kHalfLength_m);
  BodyModel model;
  model.add(shape);
  BodySystem system(model);
  system.hold(makeNail("end", {BodyId(0), end}, end));
  OdeState state = system.model().restState();
  BodyStepper stepper(system);
  constexpr double kStep_s = 1.0 / 120;
  double before = -HUGE_VAL;
  for (int i = 1; i < 240; ++i) {
    stepper.step(kStep_s, state);
    const double z = system.model().point(state.r, {BodyId(0), -end}).z() - end.z();
    if (z >= 0) return (i - z / (z - before)) * kStep_s;
    before = z;
  }
  return HUGE_VAL;
}

TEST(FittedQuadrature, LeavesThePeriodOfASwing) {
  for (const BasisPtr& basis : largeBases()) {
    const Pair pair = capsules(basis, 0.02);
    const double exact = quarterPeriod_s(pair.all);
    EXPECT_LT(exact, 1) << basis->size();
    EXPECT_NEAR(quarterPeriod_s(pair.few), exact, 0.01 * exact) << basis->size();
  }
}

TEST(FittedQuadrature, GivesBackRulesOfFewPoints) {
  const Quadrature corners = boxQuadrature(3, test::boxOf(Vec3::Ones()), 3);
  const Quadrature same = fittedQuadrature(corners, 3, {{4, 2, 2}, 7});
  EXPECT_EQ(same.size(), corners.size());
  EXPECT_EQ(same.weights, corners.weights);
}

// In the plane, and of a body without any symmetry.
TEST(FittedQuadrature, KeepsMomentsOfAnOutline) {
  const std::vector<Vec2> outline{{0, 0}, {2, 0.1}, {1.7, 0.9}, {0.9, 1.2}, {0.1, 0.8}};
  const Quadrature fine = triangulatedQuadrature(outline, 12);
  const Quadrature few = fittedQuadrature(fine, 2, {{2, 2, 0}, 3});
  EXPECT_LT(few.size(), fine.size() / 3);
  EXPECT_GT(*std::ranges::min_element(few.weights), 0);
  const auto moment = [](const Quadrature& rule, int x, int y) {
    double sum = 0;
    for (std::size_t i = 0; i < rule.size(); ++i)
      sum +=
          rule.weights[i] * std::pow(rule.points_m[i].x(), x) * std::pow(rule.points_m[i].y(), y);
    return sum;
  };
  for (int x = 0; x <= 4; ++x)
    for (int y = 0; y <= 4; ++y)
      EXPECT_NEAR(moment(few, x, y) / moment(fine, x, y), 1, 0.01) << x << " " << y;
}

// ∫ x², ∫ y², ∫ z² about the centre, and the volume.
struct SecondMoments {
  double volume;
  Vec3 squares;
};
SecondMoments momentsOf(const TriangleMesh& mesh) {
  const Quadrature mass = meshMatter(mesh, 1, 0.05, MatterDetail::of(1)).mass;
  Vec3 center = Vec3::Zero(), squares = Vec3::Zero();
  for (std::size_t i = 0; i < mass.size(); ++i) center += mass.weights[i] * mass.points_m[i];
  center /= mass.total();
  for (std::size_t i = 0; i < mass.size(); ++i)
    squares += mass.weights[i] * (mass.points_m[i] - center).cwiseAbs2();
  return {mass.total(), squares};
}

TriangleMesh tetrahedron(const Vec3& edges) {
  TriangleMesh mesh;
  for (const Vec3& p :
       {Vec3(0, 0, 0), Vec3(edges.x(), 0, 0), Vec3(0, edges.y(), 0), Vec3(0, 0, edges.z())})
    mesh.positions.push_back((p + Vec3(0.3, -0.2, 0.5)).cast<float>());
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

TEST(MeshInertia, IsThatOfTheClosedForms) {
  const Vec3 edges(0.4, 0.6, 0.9);
  const SecondMoments corner = momentsOf(tetrahedron(edges));  // 3/80 of mass times edge²
  EXPECT_NEAR(corner.volume, edges.prod() / 6, 1e-6 * corner.volume);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(corner.squares[axis], 3.0 / 80 * corner.volume * edges[axis] * edges[axis],
                1e-5 * corner.squares[axis]);
  Diagnostics diagnostics;
  const Solid ball({"sphere", {1}, {}}, "", diagnostics);
  const Vec3 radii(0.2, 0.3, 0.5);
  double lastError = HUGE_VAL;
  for (const int detail : {24, 48}) {  // chords lie inside: O(1/detail²)
    TriangleMesh mesh = ball.tessellate(detail);
    for (Eigen::Vector3f& p : mesh.positions) p = p.cwiseProduct(radii.cast<float>());
    const SecondMoments found = momentsOf(mesh);
    const double volume = 4.0 / 3 * kPi * radii.prod();
    double error = std::abs(found.volume / volume - 1);
    for (int axis = 0; axis < 3; ++axis)
      error = std::max(
          error, std::abs(found.squares[axis] / (volume / 5 * radii[axis] * radii[axis]) - 1));
    EXPECT_LT(error, 0.06);
    EXPECT_LT(error, 0.35 * lastError);
    lastError = error;
  }
}

}  // namespace
}  // namespace fascia
