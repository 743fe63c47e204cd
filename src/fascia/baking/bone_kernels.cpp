#include <fascia/baking/bone_kernels.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/baking/bone_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, kRowBlock>;
using V = hn::Vec<D>;

HWY_INLINE double sumOf(V v) {
  const D d;
  return hn::GetLane(hn::SumOfLanes(d, v));
}

void columnsTimesImpl(const double* bone, const double* x, std::size_t rows, double* out) {
  const D d;
  V c0 = hn::Zero(d), c1 = c0, c2 = c0, c3 = c0;
  for (std::size_t r = 0; r < rows; r += hn::Lanes(d)) {
    const V v = hn::LoadU(d, x + r);
    c0 = hn::MulAdd(hn::LoadU(d, bone + r), v, c0);
    c1 = hn::MulAdd(hn::LoadU(d, bone + rows + r), v, c1);
    c2 = hn::MulAdd(hn::LoadU(d, bone + 2 * rows + r), v, c2);
    c3 = hn::MulAdd(hn::LoadU(d, bone + 3 * rows + r), v, c3);
  }
  out[0] = sumOf(c0), out[1] = sumOf(c1), out[2] = sumOf(c2), out[3] = sumOf(c3);
}

// The entries above the diagonal are summed with those below: they only count together.
void productOfImpl(const double* a, const double* b, std::size_t rows, double* out) {
  const D d;
  V m00 = hn::Zero(d), m11 = m00, m22 = m00, m33 = m00;
  V m01 = m00, m02 = m00, m03 = m00, m12 = m00, m13 = m00, m23 = m00;
  for (std::size_t r = 0; r < rows; r += hn::Lanes(d)) {
    const V a0 = hn::LoadU(d, a + r), b0 = hn::LoadU(d, b + r);
    const V a1 = hn::LoadU(d, a + rows + r), b1 = hn::LoadU(d, b + rows + r);
    const V a2 = hn::LoadU(d, a + 2 * rows + r), b2 = hn::LoadU(d, b + 2 * rows + r);
    const V a3 = hn::LoadU(d, a + 3 * rows + r), b3 = hn::LoadU(d, b + 3 * rows + r);
    m00 = hn::MulAdd(a0, b0, m00);
    m11 = hn::MulAdd(a1, b1, m11);
    m22 = hn::MulAdd(a2, b2, m22);
    m33 = hn::MulAdd(a3, b3, m33);
    m01 = hn::MulAdd(a0, b1, hn::MulAdd(a1, b0, m01));
    m02 = hn::MulAdd(a0, b2, hn::MulAdd(a2, b0, m02));
    m03 = hn::MulAdd(a0, b3, hn::MulAdd(a3, b0, m03));
    m12 = hn::MulAdd(a1, b2, hn::MulAdd(a2, b1, m12));
    m13 = hn::MulAdd(a1, b3, hn::MulAdd(a3, b1, m13));
    m23 = hn::MulAdd(a2, b3, hn::MulAdd(a3, b2, m23));
  }
  out[0] = sumOf(m00), out[1] = sumOf(m11), out[2] = sumOf(m22), out[3] = sumOf(m33);
  out[4] = sumOf(m01), out[5] = sumOf(m02), out[6] = sumOf(m03);
  out[7] = sumOf(m12), out[8] = sumOf(m13), out[9] = sumOf(m23);
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(columnsTimesImpl);
HWY_EXPORT(productOfImpl);

std::array<double, 4> columnsTimes(const double* bone, const double* x, std::size_t rows) {
  std::array<double, 4> out;
  HWY_DYNAMIC_DISPATCH(columnsTimesImpl)(bone, x, rows, out.data());
  return out;
}

Quadratic productOf(const double* a, const double* b, std::size_t rows) {
  Quadratic out;
  HWY_DYNAMIC_DISPATCH(productOfImpl)(a, b, rows, out.data());
  return out;
}

}  // namespace fascia
#endif
