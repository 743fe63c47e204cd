#include <fascia/baking/simplex_least_squares.h>

#include <algorithm>
#include <array>
#include <cassert>

namespace fascia {
namespace {

// So many may differ from 0 before they are thinned out: as many as the true optimum has, mostly.
constexpr int kMostMembers = 12;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostMembers, 1>;
// G is positive definite; rounding must not make it singular.
constexpr double kLeastPivot = 1e-300;

// So many candidates are tried before the weights count as the best: the second or third in the
// order of slopes pays now and then where the first does not.
constexpr int kTries = 3;

// Weights and which of them may differ from 0, at the optimum among those.
class Support {
 public:
  Support(const CandidateMatrix& G, const CandidateVector& g)
      : G_(&G), g_(&g), scale_(G.diagonal().maxCoeff() + g.cwiseAbs().maxCoeff()) {}

  int size() const { return size_; }
  double scale() const { return scale_; }  // of the terms that cancel in gradients and costs
  double cost() const {
    double cost = 0;
    for (int r = 0; r < size_; ++r) {
      double row = -2 * (*g_)[member_[at(r)]];
      for (int c = 0; c < size_; ++c) row += (*G_)(member_[at(r)], member_[at(c)]) * w_[c];
      cost += 0.5 * w_[r] * row;
    }
    return cost;
  }
  double multiplier() const { return multiplier_; }  // of Σ w = 1: gradient of every member
  bool has(int candidate) const {
    return std::find(member_.begin(), member_.begin() + size_, candidate) !=
           member_.begin() + size_;
  }
  void start(const CandidateVector& w) {
    for (int c = 0; c < static_cast<int>(w.size()) && size_ < kMostNonZero; ++c) {
      if (w[c] > 0) add(c, w[c]);
    }
    if (size_ == 0) add(bestSingle(), 1);
    w_.head(size_) /= w_.head(size_).sum();
  }
  // The inverse of G grows by a row: with v = G⁻¹ u, u the new column's part among the members, and
  // s = G_cc - u·v, it is G⁻¹ + v vᵀ / s, bordered by -v / s and 1 / s.
  void add(int candidate, double weight) {
    assert(size_ < kMostMembers);
    SmallVector u(size_);
    for (int k = 0; k < size_; ++k) u[k] = (*G_)(member_[at(k)], candidate);
    const SmallVector v = inverse_.topLeftCorner(size_, size_) * u;
    const double s = std::max((*G_)(candidate, candidate) - u.dot(v), kLeastPivot);
    inverse_.topLeftCorner(size_, size_) += v * v.transpose() / s;
    inverse_.col(size_).head(size_) = -v / s;
    inverse_.row(size_).head(size_) = -v.transpose() / s;
    inverse_(size_, size_) = 1 / s;
    member_[at(size_)] = candidate;
    w_[size_++] = weight;
  }

  // Goes from feasible weights to the optimum over the members, dropping what would turn negative.
  void descend() {
    while (true) {
      const SmallVector best = solveEquality();
      double step = 1;
      int blocking = -1;
      for (int k = 0; k < size_; ++k) {
        if (best[k] >= 0 || size_ == 1) continue;
        const double reach = w_[k] / (w_[k] - best[k]);
        if (reach < step || blocking < 0) step = reach, blocking = k;
      }
      w_.head(size_) += step * (best - w_.head(size_));
      if (blocking < 0) break;
      remove(blocking);
    }
  }

  // Takes out the member whose loss raises the cost least. With H the inverse of G on the plane
  // Σ w = 1, taking member k out costs w_k² / (2 H_kk).
  void dropLeastMissed() {
    const SmallVector ones = inverse_.topLeftCorner(size_, size_).rowwise().sum();
    const double total = ones.sum();
    int least = 0;
    double leastCost = 0;
    for (int k = 0; k < size_; ++k) {
      const double h = inverse_(k, k) - ones[k] * ones[k] / total;
      const double cost = w_[k] * w_[k] / std::max(h, 1e-300);
      if (k == 0 || cost < leastCost) least = k, leastCost = cost;
    }
    remove(least);
    w_.head(size_) /= w_.head(size_).sum();
    descend();
  }

  // G w − g at every candidate.
  CandidateVector gradient() const {
    CandidateVector out = -*g_;
    for (int k = 0; k < size_; ++k) out += w_[k] * G_->col(member_[at(k)]);
    return out;
  }
  CandidateVector weights() const {
    CandidateVector out = CandidateVector::Zero(g_->size());
    for (int k = 0; k < size_; ++k) out[member_[at(k)]] = w_[k];
    return out;
  }

 private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }

  int bestSingle() const {
    int best = 0;
    for (int c = 1; c < static_cast<int>(g_->size()); ++c) {
      if (0.5 * (*G_)(c, c) - (*g_)[c] < 0.5 * (*G_)(best, best) - (*g_)[best]) best = c;
    }
    return best;
  }
  // The last member takes the place of the one that leaves; the inverse without it is the rest of
  // the inverse, less its column times its row over its pivot.
  void remove(int k) {
    const int last = --size_;
    member_[at(k)] = member_[at(last)];
    w_[k] = w_[last];
    inverse_.row(k).swap(inverse_.row(last));
    inverse_.col(k).swap(inverse_.col(last));
    const SmallVector gone = inverse_.col(last).head(size_);
    inverse_.topLeftCorner(size_, size_) -= gone * gone.transpose() / inverse_(last, last);
  }
  // The optimum over the members with Σ w = 1 but without w ≥ 0.
  SmallVector solveEquality() {
    SmallVector b(size_);
    for (int r = 0; r < size_; ++r) b[r] = (*g_)[member_[at(r)]];
    const auto inverse = inverse_.topLeftCorner(size_, size_);
    const SmallVector ones = inverse.rowwise().sum();
    const SmallVector free = inverse * b;
    multiplier_ = (1 - free.sum()) / ones.sum();
    return free + multiplier_ * ones;
  }

  const CandidateMatrix* G_;
  const CandidateVector* g_;
  double scale_;
  std::array<int, kMostMembers> member_{};
  int size_ = 0;
  Eigen::Matrix<double, kMostMembers, 1> w_ = Eigen::Matrix<double, kMostMembers, 1>::Zero();
  // Of G, restricted to the members: what is beyond them has no meaning.
  Eigen::Matrix<double, kMostMembers, kMostMembers> inverse_;
  double multiplier_ = 0;
};

// The candidates outside of the support whose growth lowers the cost, the fastest first; -1: none.
std::array<int, kTries> mostWanted(const Support& support) {
  const CandidateVector gradient = support.gradient();
  // Below this share of the terms that cancel in it, a gradient is rounding.
  const double least = -1e-12 * support.scale();
  std::array<int, kTries> wanted;
  wanted.fill(-1);
  std::array<double, kTries> slopes{};
  for (int c = 0; c < static_cast<int>(gradient.size()); ++c) {
    double slope = gradient[c] - support.multiplier();
    if (slope >= least || support.has(c)) continue;
    int candidate = c;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (wanted[k] >= 0 && slopes[k] <= slope) continue;
      std::swap(wanted[k], candidate);
      std::swap(slopes[k], slope);
      if (candidate < 0) break;
    }
  }
  return wanted;
}

// Lets in whoever lowers the cost, then thins out again.
Support widenAndThin(int mostNonZero, Support support) {
  // The limit only guards against rounding that cycles.
  for (int round = 0; round < 2 * kMostCandidates && support.size() < kMostMembers; ++round) {
    const int candidate = mostWanted(support).front();
    if (candidate < 0) break;
    support.add(candidate, 0);
    support.descend();
  }
  while (support.size() > mostNonZero) support.dropLeastMissed();
  return support;
}

// Changes one member at a time, as long as that pays.
void exchange(int mostNonZero, Support& support) {
  const double least = 1e-13 * support.scale();
  double cost = support.cost();
  for (int round = 0; round < 2 * kMostCandidates; ++round) {
    bool better = false;
    for (const int candidate : mostWanted(support)) {
      if (candidate < 0) break;
      Support trial = support;
      trial.add(candidate, 0);
      trial.descend();
      if (trial.size() > mostNonZero) trial.dropLeastMissed();
      const double trialCost = trial.cost();
      better = trialCost < cost - least;
      if (!better) continue;
      support = trial;
      cost = trialCost;
      break;
    }
    if (!better) break;
  }
}

}  // namespace

CandidateVector solveOnSimplex(const CandidateMatrix& G, const CandidateVector& g, int mostNonZero,
                               const CandidateVector& start) {
  assert(mostNonZero >= 1 && mostNonZero <= kMostNonZero && start.size() == g.size());
  Support now(G, g);
  now.start(start);
  now.descend();
  const Support wide = widenAndThin(mostNonZero, now);
  while (now.size() > mostNonZero) now.dropLeastMissed();
  if (wide.cost() < now.cost()) now = wide;
  exchange(mostNonZero, now);
  return now.weights();
}

}  // namespace fascia
