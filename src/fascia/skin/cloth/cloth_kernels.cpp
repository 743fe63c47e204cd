#include <fascia/skin/cloth/cloth_kernels.h>

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/cloth/cloth_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h

#include <fascia/skin/cloth/cloth_motion-inl.h>
#include <fascia/skin/cloth/cloth_rows-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

// Edges within each row, then to the row before: what one row waits for of another is one edge.
template <bool kFollows>
HWY_INLINE void sweepDownRows(const ClothLevel* coarser, ClothLevel& level, float time_s, int begin,
                              int end) {
  const Flesh flesh(level, time_s);
  const Shift shift;
  const Index half = level.half, lanes = hn::Lanes(D()), last = vectorsEnd(level) - lanes;
  const MutablePointers r = pointers(level.place);
  const auto leave = [&](int j, Index k, const Pair& p) HWY_ATTR {
    const Index at = level.rowStart(j) + k;
    setPair(r, at, half, outside(flesh, j, k, at, half, p));
  };
  for (int j = begin; j < end; ++j) {
    const bool hasBefore = j > begin;
    const int before = hasBefore ? j - 1 : j;
    const BetweenRows between(level, before);
    const Index start = level.rowStart(j), other = level.rowStart(before);
    const auto out = [&](Index k, Pair now) HWY_ATTR {
      if (hasBefore && !level.closed) {
        Pair lower = pairAt(readOnly(r), other + k, half);
        between.apply(k, lower, now);
        leave(before, k, lower);
      }
      setPair(r, start + k, half, now);
    };
    WithinRow within(level.tables.data() + level.row[static_cast<Index>(j)].inside, half, shift,
                     out);
    for (Index k = 0; k <= last; k += lanes) {
      Pair now = pairAt(readOnly(r), start + k, half);
      if constexpr (kFollows) {
        const Pair add = Following(*coarser, level, j).at(k);
        now = {now.even + add.even, now.odd + add.odd};
      }
      within.add(k, now);
    }
    within.finish(last);
    if (!level.closed) continue;
    seamEdge(level, j, r);
    if (!hasBefore) continue;
    for (Index k = 0; k <= last; k += lanes) {
      Pair lower = pairAt(readOnly(r), other + k, half), now = pairAt(readOnly(r), start + k, half);
      between.apply(k, lower, now);
      leave(before, k, lower);
      setPair(r, start + k, half, now);
    }
  }
  for (Index k = 0; k <= last; k += lanes)
    leave(end - 1, k, pairAt(readOnly(r), level.rowStart(end - 1) + k, half));
}

void sweepDownImpl(const ClothLevel* coarser, ClothLevel& level, float time_s, int begin, int end) {
  if (coarser)
    sweepDownRows<true>(coarser, level, time_s, begin, end);
  else
    sweepDownRows<false>(nullptr, level, time_s, begin, end);
}

// The same the other way round: each row's edges to the row below it, then those within it. Then
// the row is done, and goes to `finish`.
template <class Finish>
HWY_INLINE void sweepUp(ClothLevel& level, const Finish& finish, int begin, int end) {
  const Shift shift;
  const Index half = level.half, lanes = hn::Lanes(D()), last = vectorsEnd(level) - lanes;
  const MutablePointers r = pointers(level.place);
  for (int j = end - 1; j >= begin; --j) {
    const bool hasBelow = j > begin;
    const int below = hasBelow ? j - 1 : j;
    const BetweenRows between(level, below);
    const Index start = level.rowStart(j), other = level.rowStart(below);
    const auto out = [&](Index k, const Pair& now) HWY_ATTR {
      if (level.closed)
        setPair(r, start + k, half, now);
      else
        finish.vector(j, k, now);
    };
    WithinRow within(level.tables.data() + level.row[static_cast<Index>(j)].inside, half, shift,
                     out);
    for (Index k = 0; k <= last; k += lanes) {
      Pair now = pairAt(readOnly(r), start + k, half);
      if (hasBelow) {
        Pair lower = pairAt(readOnly(r), other + k, half);
        between.apply(k, lower, now);
        setPair(r, other + k, half, lower);
      }
      within.add(k, now);
    }
    within.finish(last);
    if (level.closed) {
      seamEdge(level, j, r);
      for (Index k = 0; k <= last; k += lanes)
        finish.vector(j, k, pairAt(readOnly(r), start + k, half));
    }
    finish.row(j);
  }
}

// A row that will be swept again.
class KeepRow {
 public:
  HWY_INLINE KeepRow(ClothLevel& level, float time_s)
      : level_(level), r_(pointers(level.place)), flesh_(level, time_s) {}
  HWY_INLINE void vector(int j, Index k, const Pair& p) const {
    const Index at = level_.rowStart(j) + k;
    setPair(r_, at, level_.half, outside(flesh_, j, k, at, level_.half, p));
  }
  HWY_INLINE void row(int) const {}

 private:
  const ClothLevel& level_;
  MutablePointers r_;
  Flesh flesh_;
};

void sweepUpImpl(ClothLevel& level, float time_s, int begin, int end) {
  sweepUp(level, KeepRow(level, time_s), begin, end);
}

void seamImpl(ClothLevel& level, int first) {
  const Index half = level.half, low = level.rowStart(first - 1), high = level.rowStart(first);
  const BetweenRows between(level, first - 1);
  const MutablePointers r = pointers(level.place);
  for (Index k = 0; k < vectorsEnd(level); k += hn::Lanes(D())) {
    Pair lower = pairAt(readOnly(r), low + k, half), upper = pairAt(readOnly(r), high + k, half);
    between.apply(k, lower, upper);
    setPair(r, low + k, half, lower);
    setPair(r, high + k, half, upper);
  }
}

void followImplOfCloth(const ClothLevel& coarser, ClothLevel& level, int begin, int end) {
  const MutablePointers r = pointers(level.place);
  for (int j = begin; j < end; ++j) {
    const Following following(coarser, level, j);
    for (Index k = 0; k < vectorsEnd(level); k += hn::Lanes(D())) {
      const Index at = level.rowStart(j) + k;
      const Pair now = pairAt(readOnly(r), at, level.half), add = following.at(k);
      setPair(r, at, level.half, {now.even + add.even, now.odd + add.odd});
    }
  }
}

void shearRow(ClothLevel& level, int j) {
  const Index half = level.half, low = level.rowStart(j), high = level.rowStart(j + 1);
  const ClothLevel::Row& row = level.row[static_cast<Index>(j)];
  const float* lists = level.tables.data() + row.shear;
  const MutablePointers r = pointers(level.place);
  // Each joins places of the lower row with others of the upper one, none twice.
  const auto diagonals = [&](int list, Index from, Index to) HWY_ATTR {
    const Limits limits(lists + static_cast<Index>(3 * list) * half, half);
    for (Index k = 0; k < vectorsEnd(level); k += hn::Lanes(D())) {
      const Index a = low + from + k, b = high + to + k;
      V3 first = r.at(a), second = r.at(b);
      limit<true>(limits, k, first, second);
      r.set(a, first);
      r.set(b, second);
    }
  };
  diagonals(0, 0, half);
  diagonals(1, half, 0);
  diagonals(2, half, 1);
  diagonals(3, 1, half);
  if (!level.closed) return;
  const int last = level.columns - 1;
  limitOne<true>(row.seamUp, r, level.at(last, j), level.at(0, j + 1));
  limitOne<true>(row.seamDown, r, level.at(0, j), level.at(last, j + 1));
}

void shearImpl(ClothLevel& level, int begin, int end) {
  // Every second row of cells, then the others: none waits for the one before.
  for (const int parity : {0, 1})
    for (int j = begin + parity; j < end; j += 2) shearRow(level, j);
}

void finishImplOfCloth(const ClothStep& step, std::span<ClothLevel> levels, ClothMotion& motion,
                       int begin, int end) {
  sweepUp(levels[0], FinishFinest(step, levels, motion), begin, end);
}

// Writes what a coarse level has changed, column by column.
class FinishCoarse {
 public:
  HWY_INLINE FinishCoarse(const ClothLevel& finer, ClothLevel& level, float time_s)
      : finer_(finer), level_(level), flesh_(level, time_s) {}

  HWY_INLINE void vector(int j, Index k, Pair p) const {
    const Index at = level_.rowStart(j);
    p = outside(flesh_, j, k, at + k, level_.half, p);
    setPair(pointers(level_.place), at + k, level_.half, p);
    setColumns(level_.change, at + 2 * k, p);
  }
  HWY_INLINE void row(int j) const {
    const Index from = finer_.rowStart(level_.finerRow[static_cast<Index>(j)]);
    const Index to = level_.rowStart(j);
    for (const auto axis : VectorArray::kAxes)
      subtract((finer_.place.*axis).data() + from, (level_.change.*axis).data() + to);
  }

 private:
  HWY_INLINE void subtract(const float* before, float* change) const {
    const D d;
    const Index count = static_cast<Index>(level_.columns), last = count - 1;
    const float end = change[last];
    for (Index k = 0; k < count; k += hn::Lanes(d))
      hn::StoreU(hn::Sub(hn::LoadU(d, change + k), hn::LoadU(d, before + k)), d, change + k);
    if (level_.extraColumn) change[last] = end - before[finer_.half + finer_.odds() - 1];
    change[count] = level_.closed ? change[0] : change[last];
  }

  const ClothLevel& finer_;
  ClothLevel& level_;
  Flesh flesh_;
};

void finishCoarseImpl(const ClothLevel& finer, ClothLevel& level, float time_s, int begin,
                      int end) {
  sweepUp(level, FinishCoarse(finer, level, time_s), begin, end);
}

void beginImpl(const ClothStep& first, std::span<ClothLevel> levels, ClothMotion& motion, int begin,
               int end) {
  ClothLevel& level = levels[0];
  const Start start(first, motion, level, first.time_s);
  const Index blocks = level.blocks();
  for (int j = begin; j < end; ++j) {
    std::fill_n(level.near.begin() + static_cast<std::ptrdiff_t>(static_cast<Index>(j) * blocks),
                blocks, std::uint8_t{0});
    for (Index k = 0; k < vectorsEnd(level); k += hn::Lanes(D())) takeFlesh(first, level, j, k);
    for (Index k = 0; k < vectorsEnd(level); k += hn::Lanes(D())) {
      const Index column = first.layout->row(j) + 2 * k, at = level.rowStart(j) + k;
      const Pair p = pairOfColumns(*first.position, column);
      const Pair v = pairOfColumns(*first.velocity, column);
      setPair(pointers(motion.end), at, level.half, p);
      setPair(pointers(motion.velocity), at, level.half, v);
      setPair(pointers(level.place), at, level.half, start(j, k, p, v));
    }
    passDown(levels, j, true);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(beginImpl);
HWY_EXPORT(followImplOfCloth);
HWY_EXPORT(shearImpl);
HWY_EXPORT(sweepDownImpl);
HWY_EXPORT(seamImpl);
HWY_EXPORT(sweepUpImpl);
HWY_EXPORT(finishCoarseImpl);
HWY_EXPORT(finishImplOfCloth);

void clothBegin(const ClothStep& first, std::span<ClothLevel> levels, ClothMotion& motion,
                int begin, int end) {
  HWY_DYNAMIC_DISPATCH(beginImpl)(first, levels, motion, begin, end);
}

void clothFollow(const ClothLevel& coarser, ClothLevel& level, int begin, int end) {
  HWY_DYNAMIC_DISPATCH(followImplOfCloth)(coarser, level, begin, end);
}

void clothShear(ClothLevel& level, int begin, int end) {
  HWY_DYNAMIC_DISPATCH(shearImpl)(level, begin, end);
}

void clothSweepDown(const ClothLevel* coarser, ClothLevel& level, float time_s, int begin,
                    int end) {
  HWY_DYNAMIC_DISPATCH(sweepDownImpl)(coarser, level, time_s, begin, end);
}

void clothSeam(ClothLevel& level, int first) {
  HWY_DYNAMIC_DISPATCH(seamImpl)(level, first);
}

void clothSweepUp(ClothLevel& level, float time_s, int begin, int end) {
  HWY_DYNAMIC_DISPATCH(sweepUpImpl)(level, time_s, begin, end);
}

void clothFinishCoarse(const ClothLevel& finer, ClothLevel& level, float time_s, int begin,
                       int end) {
  HWY_DYNAMIC_DISPATCH(finishCoarseImpl)(finer, level, time_s, begin, end);
}

void clothFinish(const ClothStep& step, std::span<ClothLevel> levels, ClothMotion& motion,
                 int begin, int end) {
  HWY_DYNAMIC_DISPATCH(finishImplOfCloth)(step, levels, motion, begin, end);
}

}  // namespace fascia
#endif
