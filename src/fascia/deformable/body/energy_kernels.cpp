#include <fascia/deformable/body/energy_kernels.h>

#include <algorithm>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/deformable/body/energy_kernels.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D8 = hn::CappedTag<double, SlopeTable::kPointGroup>;
using V8 = hn::Vec<D8>;
constexpr std::size_t kLanes = hn::MaxLanes(D8());

template <int kDim>
HWY_INLINE void sumGradientsOf(const SlopeTable& t, const double* HWY_RESTRICT q,
                               double* HWY_RESTRICT F) {
  const D8 d;
  for (std::size_t p = 0; p < t.pointStride; p += kLanes) {
    V8 sum[kDim * kDim];
    for (V8& s : sum) s = hn::Zero(d);
    const double* row = t.byPoint.data() + p;
    for (int j = 0; j < t.functions; ++j, q += kDim) {
      for (int axis = 0; axis < kDim; ++axis, row += t.pointStride) {
        const V8 slope = hn::Load(d, row);
        for (int r = 0; r < kDim; ++r)
          sum[axis * kDim + r] = hn::MulAdd(slope, hn::Set(d, q[r]), sum[axis * kDim + r]);
      }
    }
    q -= static_cast<std::ptrdiff_t>(t.functions) * kDim;
    for (std::size_t a = 0; a < kDim * kDim; ++a) hn::Store(sum[a], d, F + a * t.pointStride + p);
  }
}

template <int kDim>
HWY_INLINE void addStressForcesOf(const SlopeTable& t, const double* HWY_RESTRICT P,
                                  double* HWY_RESTRICT f) {
  const D8 d;
  for (int j = 0; j < t.functions; ++j) {
    V8 sum[kDim];
    for (V8& s : sum) s = hn::Zero(d);
    const double* slopes = t.byPoint.data() + static_cast<std::size_t>(j) * kDim * t.pointStride;
    for (std::size_t axis = 0; axis < kDim; ++axis) {
      for (std::size_t p = 0; p < t.pointStride; p += kLanes) {
        const V8 slope = hn::Load(d, slopes + axis * t.pointStride + p);
        for (std::size_t r = 0; r < kDim; ++r)
          sum[r] =
              hn::MulAdd(slope, hn::Load(d, P + (axis * kDim + r) * t.pointStride + p), sum[r]);
      }
    }
    for (int r = 0; r < kDim; ++r) f[j * kDim + r] += hn::GetLane(hn::SumOfLanes(d, sum[r]));
  }
}

// Points whose products stay in the first cache.
constexpr std::size_t kPointBlock = 96;
// Functions that are summed at once, in one vector or two: as many sums as there are registers for.
constexpr std::size_t kMostVectors = kLanes >= 8 ? 2 : 1;

// Z(α, r, s) = Σ_β K(rα, sβ) ∂s_j/∂X_β of one function, tensorStride numbers for each point from
// `first` up to `last`.
template <int kDim>
HWY_INLINE void timesSlopes(const SlopeTable& t, const double* HWY_RESTRICT K, int j,
                            std::size_t first, std::size_t last, double* HWY_RESTRICT Z) {
  const D8 d;
  constexpr std::size_t kStride = SlopeTable::tensorStride(kDim);
  const double* slopes = t.byPoint.data() + static_cast<std::size_t>(j) * kDim * t.pointStride;
  K += first * kDim * kStride;
  for (std::size_t p = first; p < last; ++p, K += kDim * kStride, Z += kStride) {
    for (std::size_t n = 0; n < kStride; n += kLanes) {
      V8 sum = hn::Mul(hn::Load(d, K + n), hn::Set(d, slopes[p]));
      for (std::size_t beta = 1; beta < kDim; ++beta)
        sum = hn::MulAdd(hn::Load(d, K + beta * kStride + n),
                         hn::Set(d, slopes[beta * t.pointStride + p]), sum);
      hn::Store(sum, d, Z + n);
    }
  }
}

// Adds blocks (r, s) of some functions, beginning with that of `slopes`, and of the one that Z is
// of: a row of functionStride numbers for each pair.
template <int kDim, std::size_t kVectors>
HWY_INLINE void addBlocks(const SlopeTable& t, const double* HWY_RESTRICT Z,
                          const double* HWY_RESTRICT slopes, std::size_t points,
                          double* HWY_RESTRICT blocks) {
  const D8 d;
  constexpr std::size_t kSquare = kDim * kDim;
  V8 sum[kSquare][kVectors];
  for (std::size_t rs = 0; rs < kSquare; ++rs)
    for (std::size_t v = 0; v < kVectors; ++v)
      sum[rs][v] = hn::Load(d, blocks + rs * t.functionStride + v * kLanes);
  for (std::size_t p = 0; p < points; ++p, Z += SlopeTable::tensorStride(kDim)) {
    for (std::size_t alpha = 0; alpha < kDim; ++alpha, slopes += t.functionStride) {
      V8 slope[kVectors];
      for (std::size_t v = 0; v < kVectors; ++v) slope[v] = hn::Load(d, slopes + v * kLanes);
      for (std::size_t rs = 0; rs < kSquare; ++rs) {
        const V8 z = hn::Set(d, Z[alpha * kSquare + rs]);
        for (std::size_t v = 0; v < kVectors; ++v) sum[rs][v] = hn::MulAdd(slope[v], z, sum[rs][v]);
      }
    }
  }
  for (std::size_t rs = 0; rs < kSquare; ++rs)
    for (std::size_t v = 0; v < kVectors; ++v)
      hn::Store(sum[rs][v], d, blocks + rs * t.functionStride + v * kLanes);
}

// Adds the blocks of functions from j on, and their mirror images.
template <int kDim>
HWY_INLINE void scatter(const SlopeTable& t, const double* blocks, int j, double* H,
                        std::size_t hStride) {
  for (int r = 0; r < kDim; ++r) {
    for (int s = 0; s < kDim; ++s) {
      const double* row = blocks + static_cast<std::size_t>(r * kDim + s) * t.functionStride;
      const auto at = static_cast<std::size_t>(j * kDim + s);
      for (int i = j; i < t.functions; ++i) {
        const auto other = static_cast<std::size_t>(i * kDim + r);
        H[at * hStride + other] += row[i];
        if (i != j) H[other * hStride + at] += row[i];
      }
    }
  }
}

template <int kDim>
HWY_INLINE void addCongruencesOf(const SlopeTable& t, const double* K, double* blocks, double* H,
                                 std::size_t hStride) {
  HWY_ALIGN double Z[kPointBlock * SlopeTable::tensorStride(kDim)];
  const auto functions = static_cast<std::size_t>(t.functions);
  for (int j = 0; j < t.functions; ++j) {
    std::fill_n(blocks, kDim * kDim * t.functionStride, 0.0);
    for (std::size_t p = 0; p < t.points; p += kPointBlock) {
      const std::size_t count = std::min(t.points - p, kPointBlock);
      timesSlopes<kDim>(t, K, j, p, p + count, Z);
      const double* slopes = t.byFunction.data() + p * kDim * t.functionStride;
      std::size_t i = static_cast<std::size_t>(j) / kLanes * kLanes;
      for (; i + (kMostVectors - 1) * kLanes < functions; i += kMostVectors * kLanes)
        addBlocks<kDim, kMostVectors>(t, Z, slopes + i, count, blocks + i);
      for (; i < functions; i += kLanes) addBlocks<kDim, 1>(t, Z, slopes + i, count, blocks + i);
    }
    scatter<kDim>(t, blocks, j, H, hStride);
  }
}

void sumGradientsImpl(const SlopeTable& t, const double* q, double* F) {
  t.dimension == 2 ? sumGradientsOf<2>(t, q, F) : sumGradientsOf<3>(t, q, F);
}
void addStressForcesImpl(const SlopeTable& t, const double* P, double* f) {
  t.dimension == 2 ? addStressForcesOf<2>(t, P, f) : addStressForcesOf<3>(t, P, f);
}
void addCongruencesImpl(const SlopeTable& t, const double* K, double* blocks, double* H,
                        std::size_t hStride) {
  t.dimension == 2 ? addCongruencesOf<2>(t, K, blocks, H, hStride)
                   : addCongruencesOf<3>(t, K, blocks, H, hStride);
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(sumGradientsImpl);
HWY_EXPORT(addStressForcesImpl);
HWY_EXPORT(addCongruencesImpl);

namespace {

std::size_t paddedTo(std::size_t group, std::size_t count) {
  return (count + group - 1) / group * group;
}

}  // namespace

SlopeTable::SlopeTable(int functionCount, int dimensions, const std::vector<double>& slopes)
    : functions(functionCount), dimension(dimensions) {
  const auto k = static_cast<std::size_t>(functions), axes = static_cast<std::size_t>(dimension);
  points = slopes.size() / (k * axes);
  pointStride = paddedTo(kPointGroup, points), functionStride = paddedTo(kFunctionGroup, k);
  byPoint.assign(k * axes * pointStride, 0), byFunction.assign(points * axes * functionStride, 0);
  for (std::size_t p = 0; p < points; ++p) {
    for (std::size_t j = 0; j < k; ++j) {
      for (std::size_t axis = 0; axis < axes; ++axis) {
        const double slope = slopes[(p * k + j) * axes + axis];
        byPoint[(j * axes + axis) * pointStride + p] = slope;
        byFunction[(p * axes + axis) * functionStride + j] = slope;
      }
    }
  }
}

void sumGradients(const SlopeTable& table, const double* q, double* F) {
  HWY_DYNAMIC_DISPATCH(sumGradientsImpl)(table, q, F);
}

void addStressForces(const SlopeTable& table, const double* P, double* f) {
  HWY_DYNAMIC_DISPATCH(addStressForcesImpl)(table, P, f);
}

void addCongruences(const SlopeTable& table, const double* K, double* H, std::size_t hStride,
                    DoubleArray& scratch) {
  scratch.resize(table.functionStride *
                 static_cast<std::size_t>(table.dimension * table.dimension));
  HWY_DYNAMIC_DISPATCH(addCongruencesImpl)(table, K, scratch.data(), H, hStride);
}

}  // namespace fascia
#endif
