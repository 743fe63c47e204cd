#pragma once

#include <cstddef>

namespace fascia {

// A = L Lᵀ in place for matrices of some hundred rows, by SIMD kernels that are dispatched at run
// time: n columns of n numbers, of which the lower triangle is read and written (numbers just above
// the diagonal are overwritten, too). False if A is not positive.
[[nodiscard]] bool factorDense(double* A, std::size_t n);

}  // namespace fascia
