#include <fascia/fitting/solid_fitting.h>

#include <algorithm>
#include <cmath>

#include <fascia/fitting/least_squares.h>

namespace fascia {
namespace {

enum Parameter { tx, ty, tz, rx, ry, rz, sx, sy, sz, e1, e2, taper, bend, kParameterCount };

constexpr double kOutsideFactor = 5;  // a mm too far out costs as much as this many too far in
constexpr double kReachScale = 0.35;  // of the radius: farther misses pull with constant force
constexpr int kMostIterations = 30;

// Distances at fixed points: arrays in single precision around a near origin, as kernels want them.
class Probe {
 public:
  explicit Probe(const Vec3& origin) : origin_(origin) {}

  void add(const Vec3& p) {
    const Eigen::Vector3f local = (p - origin_).cast<float>();
    points_.x.push_back(local.x());
    points_.y.push_back(local.y());
    points_.z.push_back(local.z());
  }
  const FloatArray& measure(const Solid& solid, Transform world) {
    world.translation_m -= origin_;
    distance_m_.resize(points_.size());
    normal_.resize(points_.size());
    evaluatePosed(solid, world, view(points_, 0, points_.size()), distance_m_.data(),
                  view(normal_, 0, normal_.size()));
    return distance_m_;
  }

 private:
  Vec3 origin_;
  VectorArray points_, normal_;
  FloatArray distance_m_;
};

// Square root of Huber's loss with a smooth corner: x near 0, growing like √|x| beyond the scale.
double softened(double x, double scale) {
  const double u = x / scale;
  return std::copysign(scale * std::sqrt(2 * (std::sqrt(1 + u * u) - 1)), x);
}

class Objective {
 public:
  Objective(const SolidTarget& target, const FittedSolid& guess)
      : target_(target), guess_(guess), probe_(guess.world.translation_m) {
    for (const auto& r : target.reach) probe_.add(r.position_m), total_ += r.weight;
    for (const auto& b : target.bounds) probe_.add(b.position_m);
    for (const auto& p : target.pins) probe_.add(p.position_m);
  }

  Eigen::Index count() const {
    return static_cast<Eigen::Index>(target_.reach.size() + target_.bounds.size() +
                                     target_.pins.size()) +
           kPriors;
  }

  FittedSolid solid(const Eigen::VectorXd& x) const {
    FittedSolid s = guess_;
    const Mat3& r = guess_.world.rotation;
    s.world.translation_m += target_.size_m * (r * Vec3(x[tx], x[ty], x[tz]));
    const Vec3 turn(x[rx], x[ry], x[rz]);
    if (turn.norm() > 0)
      s.world.rotation = r * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    s.half_m = guess_.half_m.cwiseProduct(
        Vec3(std::exp(x[sx]), std::exp(x[sy]), std::exp(x[sz])).cwiseMax(1e-3));
    s.half_m = s.half_m.cwiseMax(1e-4);
    s.exponent_e1 = x[e1];
    s.exponent_e2 = x[e2];
    s.taper = x[taper];
    s.bend_rad = x[bend];
    return s;
  }

  // The inverse of solid().
  Eigen::VectorXd parameters(const FittedSolid& s) const {
    Eigen::VectorXd x(static_cast<Eigen::Index>(kParameterCount));
    const Mat3 toGuess = guess_.world.rotation.transpose();
    x.segment<3>(tx) =
        toGuess * (s.world.translation_m - guess_.world.translation_m) / target_.size_m;
    const Eigen::AngleAxisd turn(toGuess * s.world.rotation);
    x.segment<3>(rx) = turn.angle() * turn.axis();
    x.segment<3>(sx) = s.half_m.cwiseQuotient(guess_.half_m).array().log();
    x[e1] = s.exponent_e1;
    x[e2] = s.exponent_e2;
    x[taper] = s.taper;
    x[bend] = s.bend_rad;
    return x;
  }

  void residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) {
    const FittedSolid s = solid(x);
    const FloatArray& d = probe_.measure(s.solid(), s.world);
    const double unit = 1 / target_.size_m;
    Eigen::Index row = 0;
    const auto distance_m = [&] { return static_cast<double>(d[static_cast<std::size_t>(row)]); };
    for (const auto& reach : target_.reach) {
      const double off = (distance_m() - reach.fat_m) * unit;
      r[row++] = std::sqrt(reach.weight / total_) *
                 (off < 0 ? kOutsideFactor * off : softened(off, kReachScale));
    }
    for (const auto& bound : target_.bounds) {
      r[row] = std::sqrt(bound.weight) * std::min(0.0, distance_m() - bound.margin_m) * unit;
      ++row;
    }
    for (const auto& pin : target_.pins) {
      r[row] = std::sqrt(pin.weight) * std::max(0.0, distance_m() + pin.depth_m) * unit;
      ++row;
    }
    writePriors(x, r, row);
  }

 private:
  static constexpr Eigen::Index kPriors = 12;

  // Weak wishes for what the points leave open: stay near the guess, round rather than boxy.
  void writePriors(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::Index row) const {
    const double p = target_.prior;
    for (const Parameter shift : {tx, ty, tz}) r[row++] = 0.5 * p * x[shift];
    for (const Parameter turn : {rx, ry, rz}) r[row++] = p * x[turn];
    r[row++] = p * (x[sx] - x[sy]);
    r[row++] = 0.5 * p * (x[sx] + x[sy] - 2 * x[sz]);
    r[row++] = p * (x[e1] - 0.9);
    r[row++] = p * (x[e2] - 0.9);
    r[row++] = p * (x[taper] - guess_.taper);
    r[row++] = 0.5 * p * x[bend];
  }

  const SolidTarget& target_;
  const FittedSolid guess_;
  Probe probe_;
  double total_ = 0;
};

LeastSquaresProblem problemFor(const SolidTarget& target, Objective& objective) {
  LeastSquaresProblem problem;
  problem.residuals = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
    objective.residuals(x, r);
  };
  problem.residualCount = objective.count();
  problem.low.resize(kParameterCount);
  problem.high.resize(kParameterCount);
  problem.low << -4, -4, -4, -1, -1, -1, -1.5, -1.5, -1.5, 0.5, 0.5, -0.75, -1.6;
  problem.high << 4, 4, 4, 1, 1, 1, 1.2, 1.2, 1.2, 1, 1, 0.75, 1.6;
  problem.step = Eigen::VectorXd::Constant(kParameterCount, 1e-3);
  if (target.symmetric) problem.step[ty] = problem.step[rx] = problem.step[rz] = 0;
  if (!target.bends) problem.step[bend] = 0;
  return problem;
}

}  // namespace

FittedSolid fitSolid(const SolidTarget& target, const FittedSolid& guess,
                     const FittedSolid& start) {
  Objective objective(target, guess);
  Eigen::VectorXd x = objective.parameters(start);
  minimize(problemFor(target, objective), x, kMostIterations);
  FittedSolid fitted = objective.solid(x);
  // Amounts that nobody sees cost a deformation for every evaluation.
  if (std::abs(fitted.bend_rad) < 0.03) fitted.bend_rad = 0;
  if (std::abs(fitted.taper) < 0.02) fitted.taper = 0;
  return fitted;
}

double residualRms_m(const SolidTarget& target, const FittedSolid& solid) {
  Probe probe(solid.world.translation_m);
  for (const auto& r : target.reach) probe.add(r.position_m);
  const FloatArray& d = probe.measure(solid.solid(), solid.world);
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < target.reach.size(); ++i) {
    const double off = static_cast<double>(d[i]) - target.reach[i].fat_m;
    sum += target.reach[i].weight * off * off;
    total += target.reach[i].weight;
  }
  return total > 0 ? std::sqrt(sum / total) : 0;
}

void distances(const FittedSolid& solid, std::span<const Vec3> points, std::vector<double>& out) {
  Probe probe(solid.world.translation_m);
  for (const Vec3& p : points) probe.add(p);
  const FloatArray& d = probe.measure(solid.solid(), solid.world);
  out.assign(d.begin(), d.end());
}

}  // namespace fascia
