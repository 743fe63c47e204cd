#include <fascia/baking/simplex_least_squares.h>

#include <Eigen/Cholesky>

#include <array>

namespace fascia {
namespace {

// The candidates whose weights may differ from 0.
struct Support {
  std::array<int, kMostCandidates> member{};
  int size = 0;

  void add(int candidate) { member[static_cast<std::size_t>(size++)] = candidate; }
  int operator[](int k) const { return member[static_cast<std::size_t>(k)]; }
  void remove(int k) {
    for (int i = k; i + 1 < size; ++i) {
      member[static_cast<std::size_t>(i)] = member[static_cast<std::size_t>(i) + 1];
    }
    --size;
  }
};

// The optimum over the support with Σ w = 1 but without w ≥ 0.
struct Equality {
  CandidateVector w;        // of the support
  CandidateMatrix inverse;  // of G, restricted to the support
  double multiplier = 0;    // of Σ w = 1: gradient of every member
};

Equality solveEquality(const CandidateMatrix& G, const CandidateVector& g, const Support& support) {
  const int n = support.size;
  CandidateMatrix A(n, n);
  CandidateVector b(n);
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < n; ++c) A(r, c) = G(support[r], support[c]);
    b[r] = g[support[r]];
  }
  Equality out;
  out.inverse = A.llt().solve(CandidateMatrix::Identity(n, n));
  const CandidateVector ones = out.inverse.rowwise().sum();
  const CandidateVector free = out.inverse * b;
  out.multiplier = (1 - free.sum()) / ones.sum();
  out.w = free + out.multiplier * ones;
  return out;
}

// Goes from feasible weights to the optimum over the support, dropping what would turn negative.
Equality descend(const CandidateMatrix& G, const CandidateVector& g, Support& support,
                 CandidateVector& w) {
  while (true) {
    Equality best = solveEquality(G, g, support);
    double step = 1;
    int blocking = -1;
    for (int k = 0; k < support.size; ++k) {
      const double from = w[support[k]];
      if (best.w[k] >= 0 || support.size == 1) continue;
      const double reach = from / (from - best.w[k]);
      if (reach < step || blocking < 0) step = reach, blocking = k;
    }
    for (int k = 0; k < support.size; ++k) {
      w[support[k]] += step * (best.w[k] - w[support[k]]);
    }
    if (blocking < 0) return best;
    w[support[blocking]] = 0;
    support.remove(blocking);
  }
}

// The candidate outside of the support whose growth lowers the cost fastest; -1: none does.
int mostWanted(const CandidateMatrix& G, const CandidateVector& g, const CandidateVector& w,
               double multiplier, const Support& support) {
  const CandidateVector gradient = G * w - g;
  // Below this share of the terms that cancel in it, a gradient is rounding.
  double least = -1e-12 * (G.diagonal().maxCoeff() + g.cwiseAbs().maxCoeff());
  int wanted = -1;
  for (int c = 0; c < static_cast<int>(w.size()); ++c) {
    bool inside = false;
    for (int k = 0; k < support.size; ++k) inside = inside || support[k] == c;
    const double slope = gradient[c] - multiplier;
    if (!inside && slope < least) least = slope, wanted = c;
  }
  return wanted;
}

// The member whose removal raises the cost least. With H the inverse of G on the plane Σ w = 1,
// taking member k out costs w_k² / (2 H_kk).
int leastMissed(const Equality& at) {
  const CandidateVector ones = at.inverse.rowwise().sum();
  const double total = ones.sum();
  int least = 0;
  double leastCost = 0;
  for (int k = 0; k < static_cast<int>(at.w.size()); ++k) {
    const double h = at.inverse(k, k) - ones[k] * ones[k] / total;
    const double cost = at.w[k] * at.w[k] / std::max(h, 1e-300);
    if (k == 0 || cost < leastCost) least = k, leastCost = cost;
  }
  return least;
}

}  // namespace

CandidateVector solveOnSimplex(const CandidateMatrix& G, const CandidateVector& g,
                               int mostNonZero) {
  const auto count = static_cast<int>(g.size());
  int first = 0;
  for (int c = 1; c < count; ++c) {
    if (0.5 * G(c, c) - g[c] < 0.5 * G(first, first) - g[first]) first = c;
  }
  CandidateVector w = CandidateVector::Zero(count);
  w[first] = 1;
  Support support;
  support.add(first);
  Equality at = solveEquality(G, g, support);
  // Every round lowers the cost; the limit only guards against rounding that cycles.
  for (int round = 0; round < 4 * count; ++round) {
    const int wanted = mostWanted(G, g, w, at.multiplier, support);
    if (wanted < 0) break;
    support.add(wanted);
    at = descend(G, g, support, w);
  }
  while (support.size > mostNonZero) {
    const int out = leastMissed(at);
    w[support[out]] = 0;
    support.remove(out);
    w /= w.sum();
    at = descend(G, g, support, w);
  }
  return w;
}

}  // namespace fascia
