#include <fascia/deformable/solve/dense_kernels.h>

#include <algorithm>
#include <cmath>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/deformable/solve/dense_kernels.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 8>;
// Columns that are eliminated at once, and columns that take their outer product at once.
constexpr std::size_t kPanel = 8, kTargets = 4;

// target −= factor source.
HWY_INLINE void subtract(double factor, const double* HWY_RESTRICT source,
                         double* HWY_RESTRICT target, std::size_t count) {
  const Doubles d;
  const auto f = hn::Set(d, factor);
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d))
    hn::StoreU(hn::NegMulAdd(f, hn::LoadU(d, source + i), hn::LoadU(d, target + i)), d, target + i);
  for (; i < count; ++i) target[i] -= factor * source[i];
}

HWY_INLINE bool factorPanel(double* A, std::size_t n, std::size_t first, std::size_t last) {
  for (std::size_t j = first; j < last; ++j) {
    double* column = A + j * n;
    if (!(column[j] > 0)) return false;
    const double scale = 1 / std::sqrt(column[j]);
    for (std::size_t i = j; i < n; ++i) column[i] *= scale;
    for (std::size_t k = j + 1; k < last; ++k)
      subtract(column[k], column + k, A + k * n + k, n - k);
  }
  return true;
}

// Columns `target` … + kTargets − 1, from the first one's diagonal on.
HWY_INLINE void subtractPanel(double* A, std::size_t n, std::size_t first, std::size_t target) {
  const Doubles d;
  const double* panel = A + first * n;
  std::size_t i = target;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    hn::Vec<Doubles> sum[kTargets];
    for (std::size_t c = 0; c < kTargets; ++c) sum[c] = hn::LoadU(d, A + (target + c) * n + i);
    for (std::size_t p = 0; p < kPanel; ++p) {
      const auto rows = hn::LoadU(d, panel + p * n + i);
      for (std::size_t c = 0; c < kTargets; ++c)
        sum[c] = hn::NegMulAdd(hn::Set(d, panel[p * n + target + c]), rows, sum[c]);
    }
    for (std::size_t c = 0; c < kTargets; ++c) hn::StoreU(sum[c], d, A + (target + c) * n + i);
  }
  for (; i < n; ++i)
    for (std::size_t c = 0; c < kTargets; ++c)
      for (std::size_t p = 0; p < kPanel; ++p)
        A[(target + c) * n + i] -= panel[p * n + target + c] * panel[p * n + i];
}

bool factorDenseImpl(double* A, std::size_t n) {
  for (std::size_t first = 0; first < n; first += kPanel) {
    const std::size_t last = std::min(n, first + kPanel);
    if (!factorPanel(A, n, first, last)) return false;
    std::size_t target = last;
    for (; target + kTargets <= n; target += kTargets) subtractPanel(A, n, first, target);
    for (; target < n; ++target)
      for (std::size_t p = first; p < last; ++p)
        subtract(A[p * n + target], A + p * n + target, A + target * n + target, n - target);
  }
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(factorDenseImpl);

bool factorDense(double* A, std::size_t n) {
  return HWY_DYNAMIC_DISPATCH(factorDenseImpl)(A, n);
}

}  // namespace fascia
#endif
