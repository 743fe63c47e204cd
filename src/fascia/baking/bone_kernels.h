#pragma once

#include <array>
#include <cstddef>

namespace fascia {

// SIMD kernels of BoneMoments; dispatched at run time. A bone is four columns of doubles, each
// `rows` long and behind the one before; rows are a multiple of kRowBlock, padded with zeros.
inline constexpr std::size_t kRowBlock = 8;

// What a quadratic form needs of a 4 × 4 matrix M, or of p pᵀ: the diagonal, then M + Mᵀ above it
// (of p pᵀ: the products once), row by row.
using Quadratic = std::array<double, 10>;

// Products of the columns with x.
std::array<double, 4> columnsTimes(const double* bone, const double* x, std::size_t rows);
// Of M = AᵀB, A and B being the bones.
Quadratic productOf(const double* a, const double* b, std::size_t rows);

}  // namespace fascia
