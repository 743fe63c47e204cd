#include <gtest/gtest.h>

#include <fascia/contact/slide_energy.h>
#include <fascia/math/log_barrier.h>

#include "contact_scenes.h"

namespace fascia {
namespace {

TEST(LogBarrier, ForceAndCurvatureAreItsDerivatives) {
  const LogBarrier energy{2e-3, 5e4};
  for (const double part : {-3.0, -0.2, 0.03, 0.0624, 0.0626, 0.2, 0.7, 0.99, 1.01, 5.0}) {
    const double d = part * energy.margin, h = 1e-5 * energy.margin;
    const double slope = (energy.value(d + h) - energy.value(d - h)) / (2 * h);
    EXPECT_NEAR(energy.force(d), -slope, 1e-6 * (std::abs(slope) + 1)) << part;
    const double rise = (energy.force(d + h) - energy.force(d - h)) / (2 * h);
    EXPECT_NEAR(energy.curvature(d), -rise, 1e-4 * (std::abs(rise) + 1)) << part;
  }
  EXPECT_EQ(energy.force(energy.margin), 0);
  EXPECT_GT(energy.force(0), 30 * energy.stiffness * energy.margin);
}

TEST(SlideEnergy, SlopeAndCurvatureAreItsDerivatives) {
  const SlideEnergy slide{1e-4};
  for (const double part : {0.01, 0.5, 0.9, 1.1, 4.0}) {
    const double y = part * slide.smoothing_m, h = 1e-5 * slide.smoothing_m;
    const double slope = (slide.value_m(y + h) - slide.value_m(y - h)) / (2 * h);
    EXPECT_NEAR(slide.slopeOverWay_per_m(y) * y, slope, 1e-6) << part;
    const double rise =
        (slide.slopeOverWay_per_m(y + h) * (y + h) - slide.slopeOverWay_per_m(y - h) * (y - h)) /
        (2 * h);
    EXPECT_NEAR(slide.curvature_per_m(y), rise, 1e-4 / slide.smoothing_m) << part;
  }
}

// Two boxes, the one on the other and both within the margin of what is below, moved a little.
class TouchingBoxes : public ::testing::Test {
 protected:
  void make(double friction) {
    scene = std::make_unique<test::BoxScene>(std::vector<test::BoxKind>(2),
                                             ContactSettings{.ground_m = 0, .friction = friction});
    scene->place(0, Vec3(0, 0.101, 0)), scene->place(1, Vec3(0.03, 0.3017, 0.02), 0.5, {0, 1, 0});
    Random random(7);
    const std::size_t n = scene->state.r.size();
    way.resize(n), direction.resize(n);
    for (double& x : way) x = 1e-4 * random.uniform(-1, 1);
    for (double& x : direction) x = 1e-4 * random.uniform(-1, 1);
    set =
        &scene->contacts->find({scene->state.r, scene->state.v, scene->state.v, test::kFrame_s, 0});
    set->evaluate(way, ContactSet::Loads::bound);
  }
  std::vector<double> gradient() const {
    std::vector<double> g(way.size(), 0.0);
    for (std::size_t b = 0; b < 2; ++b) {
      Eigen::VectorXd part = Eigen::VectorXd::Zero(12);
      set->addGradient(BodyId(b), part);
      std::ranges::copy(part, g.begin() + static_cast<std::ptrdiff_t>(12 * b));
    }
    return g;
  }
  void moveBy(double step) {
    auto moved = way;
    for (std::size_t i = 0; i < way.size(); ++i) moved[i] += step * direction[i];
    set->evaluate(moved, ContactSet::Loads::keep);
  }
  std::unique_ptr<test::BoxScene> scene;
  ContactSet* set = nullptr;
  std::vector<double> way, direction;
};

TEST_F(TouchingBoxes, GradientIsTheMeritsDerivative) {
  make(0.7);
  ASSERT_TRUE(set->hasPairs());
  set->setDirection(direction);
  const double h = 1e-5;
  const double slope = (set->merit_J(h) - set->merit_J(-h)) / (2 * h);
  double product = 0;
  const std::vector<double> g = gradient();
  for (std::size_t i = 0; i < g.size(); ++i) product += g[i] * direction[i];
  EXPECT_GT(std::abs(slope), 1e-6);
  EXPECT_NEAR(product, slope, 1e-6 * std::abs(slope));
}

TEST_F(TouchingBoxes, CurvatureAndCouplingAreTheGradientsDerivativeWithoutFriction) {
  make(0);
  std::vector<double> product(way.size(), 0.0);
  for (std::size_t b = 0; b < 2; ++b) {
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(12, 12);
    set->addCurvature(BodyId(b), lower);
    const Eigen::MatrixXd H = lower.selfadjointView<Eigen::Lower>();
    const auto first = static_cast<std::ptrdiff_t>(12 * b);
    const Eigen::VectorXd part =
        H * Eigen::Map<const Eigen::VectorXd>(direction.data() + first, 12);
    std::ranges::copy(part, product.begin() + first);
  }
  set->addCoupling(direction, product);
  const double h = 1e-6;
  moveBy(h);
  const std::vector<double> after = gradient();
  moveBy(-h);
  const std::vector<double> before = gradient();
  double largest = 0;
  for (const double x : product) largest = std::max(largest, std::abs(x));
  EXPECT_GT(largest, 0);
  for (std::size_t i = 0; i < way.size(); ++i)
    EXPECT_NEAR(product[i], (after[i] - before[i]) / (2 * h), 1e-5 * largest);
}

TEST(ContactPoints, TakeCornersFirstAndSpread) {
  const Vec3 size = Vec3::Constant(0.2);
  const BodyShapePtr shape = test::makeBar(makeAffineBasis(3), {}, size);
  const BodySurfacePtr surface = makeMeshSurface(test::boxMesh(size, 4));
  const ContactPoints points = makeContactPoints(*shape, *surface, 8);
  ASSERT_EQ(points.size(), 8u);
  for (const Vec3& X : points.X_m) EXPECT_NEAR(X.norm(), std::sqrt(0.03), 1e-6);
  const ContactPoints all = makeContactPoints(*shape, *surface, 1000);
  EXPECT_EQ(all.size(), 98u);  // 5 × 5 on each face, those of edges and corners once
}

}  // namespace
}  // namespace fascia
