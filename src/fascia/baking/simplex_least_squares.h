#pragma once

#include <Eigen/Core>

namespace fascia {

// Weights of at most this many candidates are looked for at once.
inline constexpr int kMostCandidates = 32;
using CandidateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostCandidates, 1>;
using CandidateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostCandidates, kMostCandidates>;

// Minimises ½ wᵀ G w − gᵀ w over w ≥ 0, Σ w = 1, with at most `mostNonZero` weights that are not 0:
// what the sparse, convex weights of a skinned point ask for (Le & Deng 2012, eqs. 5 and 6). G must
// be positive definite. Active sets give the optimum without the last condition; then the weight
// whose loss costs least is taken out, one after the other. Allocates nothing.
CandidateVector solveOnSimplex(const CandidateMatrix& G, const CandidateVector& g, int mostNonZero);

}  // namespace fascia
