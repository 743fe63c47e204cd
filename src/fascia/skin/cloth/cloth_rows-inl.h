// The rows of a level of cloth as SIMD lanes: points in pairs, edges between them, the flesh beside
// them, and what a coarser level adds. Included once per Highway target.
#if defined(FASCIA_SKIN_CLOTH_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_SKIN_CLOTH_ROWS_INL_H_
#undef FASCIA_SKIN_CLOTH_ROWS_INL_H_
#else
#define FASCIA_SKIN_CLOTH_ROWS_INL_H_
#endif

#include <fascia/skin/cloth/cloth_kernels.h>
#include <fascia/skin/point/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

using Index = std::size_t;

// 1/√a, exact enough for a share of an edge's excess.
HWY_INLINE V roughInverseRoot(V a) {
#if HWY_TARGET <= HWY_AVX3
  return hn::ApproximateReciprocalSqrt(a);  // 14 bits
#else
  return inverseRoot(a);
#endif
}

// The lanes of a row that continues with `next`, one on; and those of one that comes from `last`,
// one back.
class Shift {
 public:
  HWY_INLINE Shift()
      : left_(by(1)), right_(by(-1)), first_(laneIs(0)), last_(laneIs(hn::Lanes(D()) - 1)) {}
  HWY_INLINE V3 on(V3 a, V3 next) const { return turned(select(first_, next, a), left_); }
  HWY_INLINE V3 back(V3 a, V3 last) const { return turned(select(last_, last, a), right_); }
  // The first lane of b, the others of a.
  HWY_INLINE V3 startingWith(V3 b, V3 a) const { return select(first_, b, a); }

 private:
  using DI = hn::RebindToSigned<D>;
  using Turn = decltype(hn::IndicesFromVec(D(), hn::Iota(DI(), 0)));
  static HWY_INLINE Turn by(int lanes) {
    const DI di;
    const auto count = static_cast<int>(hn::Lanes(di));
    return hn::IndicesFromVec(D(), hn::And(hn::Iota(di, lanes + count), hn::Set(di, count - 1)));
  }
  static HWY_INLINE V3 turned(V3 a, const Turn& turn) {
    return {hn::TableLookupLanes(a.x, turn), hn::TableLookupLanes(a.y, turn),
            hn::TableLookupLanes(a.z, turn)};
  }
  static HWY_INLINE hn::Mask<D> laneIs(Index lane) {
    const D d;
    return hn::Eq(hn::Iota(d, 0), hn::Set(d, static_cast<float>(lane)));
  }

  Turn left_, right_;
  hn::Mask<D> first_, last_;
};

// Lists of limits, as ClothLevel's tables have them.
struct Limits {
  const float *first, *second, *length;
  HWY_INLINE Limits(const float* lists, Index half)
      : first(lists), second(lists + half), length(lists + 2 * half) {}
  HWY_INLINE void turn() { std::swap(first, second); }
};

// Brings the ends of edges together that are too long; of those with two sides, apart that are too
// short.
template <bool kTwoSided = false>
HWY_INLINE void limit(const Limits& limits, Index k, V3& a, V3& b) {
  const D d;
  const V3 way = b - a;
  const V squared = hn::MulAdd(way.x, way.x, hn::Set(d, 1e-12f));
  const V length2 = hn::MulAdd(way.y, way.y, hn::MulAdd(way.z, way.z, squared));
  V excess =
      hn::NegMulAdd(hn::LoadU(d, limits.length + k), roughInverseRoot(length2), hn::Set(d, 1.f));
  if constexpr (!kTwoSided) excess = hn::Max(excess, hn::Zero(d));
  a = mulAdd(hn::Mul(excess, hn::LoadU(d, limits.first + k)), way, a);
  b = mulAdd(hn::Neg(hn::Mul(excess, hn::LoadU(d, limits.second + k))), way, b);
}

// The same of one edge across the seam of a tube.
template <bool kTwoSided = false>
HWY_INLINE void limitOne(const ClothLevel::Limit& limit, const MutablePointers& r, Index a,
                         Index b) {
  const float x = r.x[b] - r.x[a], y = r.y[b] - r.y[a], z = r.z[b] - r.z[a];
  const float squared = x * x + y * y + z * z;
  if (!kTwoSided && squared <= limit.length_m * limit.length_m) return;
  const float excess = 1 - limit.length_m / std::sqrt(squared + 1e-12f);
  const float first = excess * limit.first, second = -excess * limit.second;
  r.x[a] += first * x, r.y[a] += first * y, r.z[a] += first * z;
  r.x[b] += second * x, r.y[b] += second * y, r.z[b] += second * z;
}

struct Pair {
  V3 even, odd;
};
HWY_INLINE Pair pairAt(const Pointers& p, Index k, Index half) {
  return {p.at(k), p.at(k + half)};
}
HWY_INLINE void setPair(const MutablePointers& p, Index k, Index half, const Pair& v) {
  p.set(k, v.even);
  p.set(k + half, v.odd);
}
HWY_INLINE Pointers readOnly(const MutablePointers& p) {
  return {p.x, p.y, p.z};
}

// Where columns lie one after the other, k even.
HWY_INLINE Pair pairOfColumns(const VectorArray& a, Index k) {
  const D d;
  Pair v;
  hn::LoadInterleaved2(d, a.x.data() + k, v.even.x, v.odd.x);
  hn::LoadInterleaved2(d, a.y.data() + k, v.even.y, v.odd.y);
  hn::LoadInterleaved2(d, a.z.data() + k, v.even.z, v.odd.z);
  return v;
}
HWY_INLINE void setColumns(VectorArray& a, Index k, const Pair& v) {
  const D d;
  hn::StoreInterleaved2(v.even.x, v.odd.x, d, a.x.data() + k);
  hn::StoreInterleaved2(v.even.y, v.odd.y, d, a.y.data() + k);
  hn::StoreInterleaved2(v.even.z, v.odd.z, d, a.z.data() + k);
}

// The half spaces of one level at one moment.
class Flesh {
 public:
  HWY_INLINE Flesh(const ClothLevel& level, float time_s)
      : normal_(pointers(level.normal)),
        offset_(level.offset.data()),
        rate_(level.rate.data()),
        near_(level.near.data()),
        blocks_(level.blocks()),
        time_s_(time_s) {}

  HWY_INLINE bool isNear(int j, Index k) const {
    return near_[static_cast<Index>(j) * blocks_ + k / ClothLevel::kBlock] != 0;
  }
  HWY_INLINE V3 normal(Index at) const { return normal_.at(at); }
  // How far the flesh has come into p's half space; ≤ 0: not at all.
  HWY_INLINE V depth(V3 p, Index at) const {
    const D d;
    const V limit =
        hn::MulAdd(hn::Set(d, time_s_), hn::LoadU(d, rate_ + at), hn::LoadU(d, offset_ + at));
    return hn::Sub(limit, dot(normal(at), p));
  }
  HWY_INLINE V3 outside(V3 p, Index at) const {
    return mulAdd(hn::Max(depth(p, at), hn::Zero(D())), normal(at), p);
  }

 private:
  Pointers normal_;
  const float *offset_, *rate_;
  const std::uint8_t* near_;
  Index blocks_;
  float time_s_;
};

// What a coarser level adds to a row of a finer one: linear between its rows and columns.
class Following {
 public:
  HWY_INLINE Following(const ClothLevel& coarser, const ClothLevel& level, int j)
      : oddShare_(level.oddShare.data()), share_(level.row[static_cast<Index>(j)].share) {
    const Index at = coarser.rowStart(level.row[static_cast<Index>(j)].coarser);
    const Pointers change = pointers(coarser.change);
    low_ = {change.x + at, change.y + at, change.z + at};
    const Index stride = coarser.stride();
    high_ = {low_.x + stride, low_.y + stride, low_.z + stride};
  }
  HWY_INLINE Pair at(Index k) const {
    const D d;
    const V3 here = between(k), next = between(k + 1);
    return {here, mulAdd(hn::LoadU(d, oddShare_ + k), next - here, here)};
  }

 private:
  HWY_INLINE V3 between(Index k) const {
    const V3 low = low_.at(k);
    return mulAdd(hn::Set(D(), share_), high_.at(k) - low, low);
  }

  Pointers low_, high_;
  const float* oddShare_;
  float share_;
};

// A row's edges within it, a vector at a time from the first on: `out(k, row)` gets vector k once
// they are all done. Even ones, then odd ones, whose second ends are in the next vector at times.
template <class Out>
class WithinRow {
 public:
  HWY_INLINE WithinRow(const float* lists, Index half, const Shift& shift, const Out& out)
      : even_(lists, half), odd_(lists + 3 * half, half), shift_(shift), out_(out) {}

  HWY_INLINE void add(Index k, Pair now) {
    limit(even_, k, now.even, now.odd);
    if (k > 0) complete(k - hn::Lanes(D()), now.even);
    before_ = now;
  }
  HWY_INLINE void finish(Index last) { complete(last, before_.even); }

 private:
  HWY_INLINE void complete(Index k, V3 next) {
    V3 right = shift_.on(before_.even, next);
    limit(odd_, k, before_.odd, right);
    V3 left = shift_.back(right, carried_);
    if (k == 0) left = shift_.startingWith(before_.even, left);
    carried_ = right;
    out_(k, Pair{left, before_.odd});
  }

  Limits even_, odd_;
  const Shift& shift_;
  const Out& out_;
  Pair before_{};  // the vector before, without its odd edges
  V3 carried_{};   // the second ends of the odd edges before those
};

// Both rows' ends of the edges between them.
struct BetweenRows {
  Limits even, odd;
  HWY_INLINE BetweenRows(const ClothLevel& level, int lower)
      : even(level.tables.data() + level.row[static_cast<Index>(lower)].above, level.half),
        odd(even.length + level.half, level.half) {}
  HWY_INLINE void apply(Index k, Pair& lower, Pair& upper) const {
    limit(even, k, lower.even, upper.even);
    limit(odd, k, lower.odd, upper.odd);
  }
};

HWY_INLINE Index vectorsEnd(const ClothLevel& level) {
  return level.blocks() * ClothLevel::kBlock;
}
HWY_INLINE void seamEdge(const ClothLevel& level, int j, const MutablePointers& r) {
  limitOne(level.row[static_cast<Index>(j)].seam, r, level.at(level.columns - 1, j),
           level.at(0, j));
}
HWY_INLINE Pair outside(const Flesh& flesh, int j, Index k, Index at, Index half, const Pair& p) {
  if (!flesh.isNear(j, k)) return p;
  return {flesh.outside(p.even, at), flesh.outside(p.odd, at + half)};
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#endif
