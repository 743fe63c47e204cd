#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>

#include <fascia/base/random.h>
#include <fascia/deformable/matter/quadrature.h>

// Rules of Gauss's kind for the matter of any body: with free places a point has as many unknowns
// as there are dimensions and one more, so that a quarter of the points do of those that
// reducedQuadrature() needs. Found by Levenberg and Marquardt's method from the centres of clusters
// of the samples (after Xiao & Gimbutas 2010, who remove points of a rule instead, which takes
// longer).

namespace fascia {
namespace {

// How many functions the products have that are to be integrated: with 2 the energy at rest is
// exact and its third derivative off by a tenth; with 3 forces and stiffnesses of bodies that loads
// strain by a tenth are within 1 %, with 3.5 well so.
constexpr double kMostFactors = 3.5, kLeastFactors = 2, kFactorStep = 0.25;
// A fit's time grows with the cube of the first: some seconds. A body's steps take as long as it
// has points, a quarter of the second.
constexpr std::size_t kMostMoments = 400, kMostMirroredMoments = 900;
// Unknowns for each moment, try by try, each from a start of its own. Fewer find no fit, more are
// slower bodies.
constexpr std::array kSurpluses{1.15, 1.15, 1.15, 1.25, 1.25, 1.25, 1.4, 1.4, 1.4, 1.6, 1.6, 1.6};
// Of moments whose weight is 1, in the norm over all of them. Bodies with more error than the
// second keep all samples.
constexpr double kWantedError = 1e-3, kMostError = 1e-2;
constexpr int kFitIterations = 200, kClusterRounds = 12;

using Exponents = std::vector<Eigen::Vector3i>;
using Mirrors = std::array<bool, 3>;

// Legendre's polynomials of norm 1 over [-1, 1], which keep moments of high degrees apart.
struct Legendre {
  std::vector<double> value, slope;

  void evaluate(int degree, double x) {
    value.assign(static_cast<std::size_t>(degree) + 2, 0);
    slope.assign(value.size(), 0);
    value[0] = 1, value[1] = x, slope[1] = 1;
    for (std::size_t n = 1; n + 1 < value.size(); ++n) {
      const auto k = static_cast<double>(n);
      value[n + 1] = ((2 * k + 1) * x * value[n] - k * value[n - 1]) / (k + 1);
      slope[n + 1] = slope[n - 1] + (2 * k + 1) * value[n];
    }
    for (std::size_t n = 0; n < value.size(); ++n) {
      const double norm = std::sqrt(2 * static_cast<double>(n) + 1);
      value[n] *= norm, slope[n] *= norm;
    }
  }
};

// The products of Legendre's polynomials at a point of the cube [-1, 1]³.
class Moments {
 public:
  explicit Moments(Exponents exponents) : exponents_(std::move(exponents)) {
    for (const Eigen::Vector3i& e : exponents_) degree_ = std::max(degree_, e.maxCoeff());
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(exponents_.size()); }

  void evaluate(const Vec3& u) {
    for (int axis = 0; axis < 3; ++axis) factors_[axis].evaluate(degree_, u[axis]);
  }
  double value(Eigen::Index m) const {
    const Eigen::Vector3i& e = exponents_[static_cast<std::size_t>(m)];
    return factor(0, e) * factor(1, e) * factor(2, e);
  }
  Vec3 slope(Eigen::Index m) const {
    const Eigen::Vector3i& e = exponents_[static_cast<std::size_t>(m)];
    const double x = factor(0, e), y = factor(1, e), z = factor(2, e);
    return {rate(0, e) * y * z, x * rate(1, e) * z, x * y * rate(2, e)};
  }

 private:
  double factor(int axis, const Eigen::Vector3i& e) const {
    return factors_[axis].value[static_cast<std::size_t>(e[axis])];
  }
  double rate(int axis, const Eigen::Vector3i& e) const {
    return factors_[axis].slope[static_cast<std::size_t>(e[axis])];
  }

  Exponents exponents_;
  int degree_ = 0;
  std::array<Legendre, 3> factors_;
};

Exponents exponentsOf(int dimension, const Basis::Degrees& slopes, double factors,
                      const Mirrors& mirrored) {
  const auto most = [&](int degree) { return static_cast<int>(factors * degree + 1e-9); };
  const auto step = [&](int axis) { return mirrored[static_cast<std::size_t>(axis)] ? 2 : 1; };
  Exponents found;
  for (int z = 0; z <= (dimension == 3 ? most(slopes.axes.z()) : 0); z += step(2))
    for (int y = 0; y <= most(slopes.axes.y()); y += step(1))
      for (int x = 0; x <= most(slopes.axes.x()); x += step(0))
        if (x + y + z <= most(slopes.total)) found.emplace_back(x, y, z);
  return found;
}

// A rule in the cube that its samples fill, of weight 1.
struct CubeRule {
  std::vector<Vec3> points;
  std::vector<double> weights;
};

// Axes along which nothing changes if all is mirrored: to the moments up to degree 3 across.
Mirrors mirrorsOf(int dimension, const CubeRule& samples) {
  Mirrors mirrored{};
  for (int axis = 0; axis < dimension; ++axis) {
    double worst = 0;
    for (int i = 0; i < 9; ++i) {
      double first = 0, third = 0;
      for (std::size_t s = 0; s < samples.points.size(); ++s) {
        const Vec3& u = samples.points[s];
        const double others =
            std::pow(u[(axis + 1) % 3], i % 3) * std::pow(u[(axis + 2) % 3], i / 3);
        first += samples.weights[s] * u[axis] * others;
        third += samples.weights[s] * std::pow(u[axis], 3) * others;
      }
      worst = std::max({worst, std::abs(first), std::abs(third)});
    }
    mirrored[static_cast<std::size_t>(axis)] = worst < 1e-6;
  }
  return mirrored;
}

// Centres and weights of `count` clusters (Lloyd 1982), near where the distances of `stretch` times
// the coordinates are small.
CubeRule clusters(const CubeRule& samples, std::size_t count, const Vec3& stretch,
                  std::uint64_t seed) {
  CubeRule out;
  Random random(seed);
  const auto samplesCount = static_cast<double>(samples.points.size());
  for (std::size_t c = 0; c < count; ++c)
    out.points.push_back(samples.points[static_cast<std::size_t>(random.uniform(0, samplesCount))]);
  for (int round = 0; round < kClusterRounds; ++round) {
    std::vector<Vec3> sums(count, Vec3::Zero());
    out.weights.assign(count, 0);
    for (std::size_t s = 0; s < samples.points.size(); ++s) {
      std::size_t nearest = 0;
      double least = HUGE_VAL;
      for (std::size_t c = 0; c < count; ++c) {
        const double d = (samples.points[s] - out.points[c]).cwiseProduct(stretch).squaredNorm();
        if (d < least) least = d, nearest = c;
      }
      sums[nearest] += samples.weights[s] * samples.points[s];
      out.weights[nearest] += samples.weights[s];
    }
    for (std::size_t c = 0; c < count; ++c)
      if (out.weights[c] > 0) out.points[c] = sums[c] / out.weights[c];
  }
  const double least = 0.1 / static_cast<double>(count);
  for (double& w : out.weights) w = std::max(w, least);
  return out;
}

// Weights are changed by factors, which keeps them positive; places stay in the cube.
class Fit {
 public:
  Fit(const CubeRule& samples, int dimension, Exponents exponents, CubeRule start,
      const Vec3& stretch)
      : dimension_(dimension),
        moments_(std::move(exponents)),
        stretch_(stretch),
        rule_(std::move(start)),
        wanted_(sum(samples, Eigen::VectorXd::Zero(moments_.size()))) {
    jacobian_.resize(moments_.size(), unknowns() * count());
  }

  double run() {
    Eigen::VectorXd residual = linearize();
    double damping = 1e-3;
    for (int i = 0, failures = 0; i < kFitIterations && failures < 12; ++i) {
      if (residual.norm() < 0.1 * kWantedError) break;
      const CubeRule next = moved(step(residual, damping));
      if (sum(next, -wanted_).norm() < residual.norm()) {
        rule_ = next, residual = linearize();
        damping = std::max(0.3 * damping, 1e-12), failures = 0;
      } else {
        damping *= 4, ++failures;
      }
    }
    return residual.norm();
  }
  const CubeRule& rule() const { return rule_; }

 private:
  Eigen::Index unknowns() const { return dimension_ + 1; }  // of each point
  Eigen::Index count() const { return static_cast<Eigen::Index>(rule_.points.size()); }

  Eigen::VectorXd sum(const CubeRule& rule, Eigen::VectorXd start) {
    for (std::size_t i = 0; i < rule.points.size(); ++i) {
      moments_.evaluate(rule.points[i]);
      for (Eigen::Index m = 0; m < start.size(); ++m)
        start[m] += rule.weights[i] * moments_.value(m);
    }
    return start;
  }
  Eigen::VectorXd linearize() {
    Eigen::VectorXd residual = -wanted_;
    for (Eigen::Index i = 0; i < count(); ++i) {
      const double weight = rule_.weights[static_cast<std::size_t>(i)];
      moments_.evaluate(rule_.points[static_cast<std::size_t>(i)]);
      for (Eigen::Index m = 0; m < residual.size(); ++m) {
        const double change = weight * moments_.value(m);
        const Vec3 slope = weight * moments_.slope(m).cwiseQuotient(stretch_);
        residual[m] += change;
        jacobian_.row(m).segment(unknowns() * i, dimension_) = slope.head(dimension_);
        jacobian_(m, unknowns() * i + dimension_) = change;
      }
    }
    return residual;
  }
  // The least change that does it, there are more unknowns than moments.
  Eigen::VectorXd step(const Eigen::VectorXd& residual, double damping) const {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(residual.size(), residual.size());
    normal.selfadjointView<Eigen::Lower>().rankUpdate(jacobian_);
    normal.diagonal().array() += damping * normal.trace() / static_cast<double>(residual.size());
    return -jacobian_.transpose() * normal.selfadjointView<Eigen::Lower>().llt().solve(residual);
  }
  CubeRule moved(const Eigen::VectorXd& step) const {
    constexpr double kFarthest = 0.5, kLargestGrowth = 0.7;
    CubeRule next = rule_;
    for (std::size_t i = 0; i < next.points.size(); ++i) {
      const Eigen::Index first = unknowns() * static_cast<Eigen::Index>(i);
      for (int axis = 0; axis < dimension_; ++axis) {
        const double way = std::clamp(step[first + axis], -kFarthest, kFarthest) / stretch_[axis];
        next.points[i][axis] = std::clamp(next.points[i][axis] + way, -1.0, 1.0);
      }
      next.weights[i] *=
          std::exp(std::clamp(step[first + dimension_], -kLargestGrowth, kLargestGrowth));
    }
    return next;
  }

  int dimension_;
  Moments moments_;
  Vec3 stretch_;
  CubeRule rule_;
  Eigen::VectorXd wanted_;
  Eigen::MatrixXd jacobian_;  // moments x unknowns of all points
};

struct Cube {
  Vec3 center, half;
};

Cube cubeAround(const Quadrature& rule) {
  Box box;
  for (const Vec3& p : rule.points_m) box.add(p);
  return {box.center(), (0.5 * box.size()).cwiseMax(1e-12)};
}

// Samples where mirrored ones lie on top of each other.
CubeRule folded(CubeRule samples, const Mirrors& mirrored) {
  for (Vec3& u : samples.points)
    for (int axis = 0; axis < 3; ++axis)
      if (mirrored[static_cast<std::size_t>(axis)]) u[axis] = std::abs(u[axis]);
  return samples;
}

Quadrature unfolded(CubeRule rule, const Mirrors& mirrored, const Cube& cube, double volume) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!mirrored[static_cast<std::size_t>(axis)]) continue;
    const std::size_t count = rule.points.size();
    for (std::size_t i = 0; i < count; ++i) {
      rule.weights[i] *= 0.5;
      rule.weights.push_back(rule.weights[i]);
      rule.points.push_back(rule.points[i]);
      rule.points.back()[axis] *= -1;
    }
  }
  Quadrature out;
  for (std::size_t i = 0; i < rule.points.size(); ++i)
    out.add(cube.center + cube.half.cwiseProduct(rule.points[i]), volume * rule.weights[i]);
  return out;
}

// Starts from different clusters, first with few points; none if no try comes near enough.
std::optional<CubeRule> fitted(const CubeRule& samples, int dimension, const Exponents& exponents,
                               const Vec3& stretch, std::size_t mostPoints) {
  CubeRule best;
  double least = kMostError;
  for (std::size_t attempt = 0; attempt < kSurpluses.size() && least > kWantedError; ++attempt) {
    const double unknowns = kSurpluses[attempt] * static_cast<double>(exponents.size()) + 4;
    const auto count = static_cast<std::size_t>(unknowns / (dimension + 1));
    if (count >= mostPoints) break;
    Fit fit(samples, dimension, exponents, clusters(samples, count, stretch, attempt), stretch);
    const double error = fit.run();
    if (error < least) best = fit.rule(), least = error;
  }
  if (!(least < kMostError)) return {};
  return best;
}

}  // namespace

Quadrature fittedQuadrature(const Quadrature& rule, int dimension, const Basis::Degrees& degrees) {
  if (degrees.total <= 0) return rule;
  const Cube cube = cubeAround(rule);
  const double volume = rule.total();
  CubeRule samples;
  for (std::size_t i = 0; i < rule.size(); ++i) {
    samples.points.push_back((rule.points_m[i] - cube.center).cwiseQuotient(cube.half));
    samples.weights.push_back(rule.weights[i] / volume);
  }
  const Mirrors mirrored = mirrorsOf(dimension, samples);
  samples = folded(std::move(samples), mirrored);
  const auto images = static_cast<std::size_t>(1)
                      << std::count(mirrored.begin(), mirrored.end(), true);
  const std::size_t mostMoments = std::min(kMostMoments, kMostMirroredMoments / images);
  const Vec3 stretch = degrees.axes.cast<double>().cwiseMax(1.0);
  for (double factors = kMostFactors; factors >= kLeastFactors; factors -= kFactorStep) {
    const Exponents exponents = exponentsOf(dimension, degrees, factors, mirrored);
    if (exponents.size() > mostMoments && factors > kLeastFactors) continue;
    const std::optional<CubeRule> found =
        fitted(samples, dimension, exponents, stretch, rule.size() / images);
    if (found) return unfolded(*found, mirrored, cube, volume);
  }
  return rule;
}

}  // namespace fascia
