#pragma once

#include <Eigen/Core>

namespace fascia {

// Weights of at most this many candidates are looked for at once, of which so many may be used.
inline constexpr int kMostCandidates = 32;
inline constexpr int kMostNonZero = 8;
using CandidateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostCandidates, 1>;
using CandidateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostCandidates, kMostCandidates>;

// Minimises ½ wᵀ G w − gᵀ w over w ≥ 0, Σ w = 1, with at most `mostNonZero` weights that are not 0:
// what the sparse, convex weights of a skinned point ask for (Le & Deng 2012, eqs. 5 and 6). G must
// be positive definite.
//
// Which weights may differ from 0 is searched for from those of `start` (all 0: from the best
// single one). Candidates whose growth lowers the cost come in, more than may stay; then the weight
// whose loss costs least is taken out, one after the other; at the end single ones are exchanged,
// as long as that pays. Between, active sets give the optimum. Exchanging alone ends in worse
// choices; active sets over all candidates cost many times more and end in no better ones.
// Allocates nothing.
CandidateVector solveOnSimplex(const CandidateMatrix& G, const CandidateVector& g, int mostNonZero,
                               const CandidateVector& start);

}  // namespace fascia
