#include <fascia/skin/cloth/cloth_kernels.h>

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/cloth/cloth_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h

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

// A list of a level's row to the row of the coarser one that it is.
HWY_INLINE void toCoarser(const ClothLevel& level, const ClothLevel& coarser, Index from, Index to,
                          const FloatArray& source, FloatArray& target) {
  const D d;
  const float* in = source.data() + from;
  float* out = target.data() + to;
  for (Index k = 0; k < coarser.blocks() * ClothLevel::kBlock; k += hn::Lanes(d)) {
    V even, odd;
    hn::LoadInterleaved2(d, in + 2 * k, even, odd);
    hn::StoreU(even, d, out + k);
    hn::StoreU(odd, d, out + k + coarser.half);
  }
  if (!coarser.extraColumn) return;
  const Index last = static_cast<Index>(coarser.columns) - 1;
  out[(last % 2) * coarser.half + last / 2] = in[level.half + level.odds() - 1];
}

// Row j of the finest level to all coarser levels that have it; half spaces too, if asked for.
HWY_INLINE void passDown(std::span<ClothLevel> levels, int j, bool withFlesh) {
  for (Index l = 0; l + 1 < levels.size(); ++l) {
    const ClothLevel& level = levels[l];
    ClothLevel& coarser = levels[l + 1];
    const int row = level.row[static_cast<Index>(j)].onCoarser;
    if (row < 0) return;
    const Index from = level.rowStart(j), to = coarser.rowStart(row);
    const auto pass = [&](const FloatArray& source, FloatArray& target)
                          HWY_ATTR { toCoarser(level, coarser, from, to, source, target); };
    pass(level.place.x, coarser.place.x);
    pass(level.place.y, coarser.place.y);
    pass(level.place.z, coarser.place.z);
    if (withFlesh) {
      bool any = false;
      const std::uint8_t* fine = level.near.data() + static_cast<Index>(j) * level.blocks();
      std::uint8_t* coarse = coarser.near.data() + static_cast<Index>(row) * coarser.blocks();
      for (Index b = 0; b < coarser.blocks(); ++b) {
        const Index last = std::min(2 * b + 1, level.blocks() - 1);
        coarse[b] = fine[std::min(2 * b, last)] | fine[last];
        any = any || coarse[b] != 0;
      }
      if (any) {
        pass(level.normal.x, coarser.normal.x);
        pass(level.normal.y, coarser.normal.y);
        pass(level.normal.z, coarser.normal.z);
        pass(level.offset, coarser.offset);
        pass(level.rate, coarser.rate);
      }
    }
    j = row;
  }
}

// Where a point is at a step's end if nothing stops it.
class Start {
 public:
  HWY_INLINE Start(const ClothStep& step, const ClothMotion& motion, const ClothLevel& finest,
                   float time_s)
      : step_(step), motion_(motion), finest_(finest), flesh_(finest, time_s), time_s_(time_s) {}

  HWY_INLINE Pair operator()(int j, Index k, const Pair& end, const Pair& velocity) const {
    const float* lists = motion_.tables.data() + motion_.row[static_cast<Index>(j)];
    Pair out{free(lists + k, end.even, velocity.even),
             free(lists + finest_.half + k, end.odd, velocity.odd)};
    if (motion_.hasStrands[static_cast<Index>(j)] != 0) hang(lists, j, k, end, out);
    return outside(flesh_, j, k, finest_.rowStart(j) + k, finest_.half, out);
  }

 private:
  HWY_INLINE V3 free(const float* lists, V3 end, V3 velocity) const {
    const D d;
    const V kept = hn::Mul(hn::Set(d, step_.step_s), hn::LoadU(d, lists));
    const V fall = hn::LoadU(d, lists + 2 * finest_.half);
    const float* g = step_.inputs->gravity;
    const V3 there = mulAdd(kept, velocity, end);
    return {hn::MulAdd(fall, hn::Set(d, g[0]), there.x),
            hn::MulAdd(fall, hn::Set(d, g[1]), there.y),
            hn::MulAdd(fall, hn::Set(d, g[2]), there.z)};
  }
  // Tissue (Turner & Gobbetti 1998, eq. 3), implicitly: pulls only beyond its rest length.
  HWY_INLINE void hang(const float* lists, int j, Index k, const Pair& end, Pair& out) const {
    const PointSurroundings& around = *step_.inputs->surroundings;
    const Index column = step_.layout->row(j) + 2 * k;
    const Pair anchor = pairOfColumns(around.anchor, column);
    const Pair speed = pairOfColumns(around.anchorVelocity, column);
    const float* own = lists + 4 * finest_.half + k;
    out.even = hung(own, anchor.even, speed.even, end.even, out.even);
    out.odd = hung(own + finest_.half, anchor.odd, speed.odd, end.odd, out.odd);
  }
  HWY_INLINE V3 hung(const float* own, V3 anchor, V3 speed, V3 end, V3 p) const {
    const D d;
    const Index list = 2 * finest_.half;
    const V h = hn::Set(d, step_.step_s);
    const V3 strand = p - mulAdd(hn::Set(d, time_s_), speed, anchor);
    const V squared = hn::Add(dot(strand, strand), hn::Set(d, 1e-16f));
    const V inverse = inverseRoot(squared), rest = hn::LoadU(d, own + 2 * list);
    const V excess = hn::NegMulAdd(rest, inverse, hn::Set(d, 1.f));
    const auto taut = hn::Gt(excess, hn::Zero(d));
    const V pull = hn::IfThenElseZero(taut, hn::Mul(hn::LoadU(d, own), excess));
    const V3 way = (p - end) - scaled(h, speed);
    const V along = hn::Mul(dot(way, strand), hn::Mul(inverse, inverse));
    // Strands without a length hold a point from all sides, and damp it so.
    const V3 closing = select(hn::Eq(rest, hn::Zero(d)), way, scaled(along, strand));
    const V damped = hn::IfThenElseZero(taut, hn::LoadU(d, own + list));
    return mulAdd(hn::Neg(pull), strand, mulAdd(hn::Neg(damped), closing, p));
  }

  const ClothStep& step_;
  const ClothMotion& motion_;
  const ClothLevel& finest_;
  Flesh flesh_;
  float time_s_;
};

// Ends the step of finished rows of the finest level.
class FinishFinest {
 public:
  HWY_INLINE FinishFinest(const ClothStep& step, std::span<ClothLevel> levels, ClothMotion& motion)
      : step_(step),
        levels_(levels),
        level_(levels[0]),
        r_(pointers(level_.place)),
        end_(pointers(motion.end)),
        velocity_(pointers(motion.velocity)),
        flesh_(level_, step.time_s),
        next_(step, motion, level_, step.time_s + step.step_s) {}

  HWY_INLINE void vector(int j, Index k, Pair p) const {
    const Index half = level_.half, at = level_.rowStart(j) + k;
    Pair v = pairAt(readOnly(velocity_), at, half);
    const Pair start = pairAt(readOnly(end_), at, half);
    if (flesh_.isNear(j, k)) {
      const Pair flesh =
          pairOfColumns(step_.inputs->surroundings->fleshVelocity, step_.layout->row(j) + 2 * k);
      p.even = touch(at, start.even, flesh.even, p.even, v.even);
      p.odd = touch(at + half, start.odd, flesh.odd, p.odd, v.odd);
    } else {
      v = {swung(p.even, start.even, v.even), swung(p.odd, start.odd, v.odd)};
    }
    if (step_.isLast) {
      const Index column = step_.layout->row(j) + 2 * k;
      setColumns(*step_.position, column, p);
      setColumns(*step_.velocity, column, v);
      return;
    }
    setPair(end_, at, half, p);
    setPair(velocity_, at, half, v);
    setPair(r_, at, half, next_(j, k, p, v));
  }
  HWY_INLINE void row(int j) const {
    if (!step_.isLast) {
      passDown(levels_, j, false);
      return;
    }
    for (FloatArray* a : {&step_.position->x, &step_.position->y, &step_.position->z}) {
      float* row = a->data() + step_.layout->row(j);
      row[-1] = row[step_.layout->columns - 1];
      row[step_.layout->columns] = row[0];
    }
  }

 private:
  HWY_INLINE V3 mean(V3 p, V3 start) const {
    return scaled(hn::Set(D(), 1 / step_.step_s), p - start);
  }
  // The velocity at the step's end, from that at its start and the way between them.
  HWY_INLINE V3 swung(V3 p, V3 start, V3 v) const {
    const V3 now = mean(p, start);
    return mulAdd(hn::Set(D(), step_.swing), now - v, now);
  }
  // The same of points that may have come to the flesh: they end on it, and go on along it.
  HWY_INLINE V3 touch(Index at, V3 start, V3 flesh, V3 p, V3& v) const {
    const D d;
    const V zero = hn::Zero(d), depth = flesh_.depth(p, at);
    const V3 normal = flesh_.normal(at);
    const auto inside = hn::Gt(depth, hn::Set(d, -step_.touch_m));
    const V3 out = mulAdd(hn::Max(depth, zero), normal, p);
    const V3 relative = mean(out, start) - flesh;
    const V outward = dot(relative, normal);
    const StepCoefficients& s = *step_.inputs->step;
    const V bounced =
        hn::IfThenElse(hn::Lt(outward, zero), hn::Mul(hn::Set(d, -s.bounce), outward), outward);
    const V3 tangential = scaled(hn::Set(d, s.slide), mulAdd(hn::Neg(outward), normal, relative));
    v = select(inside, flesh + mulAdd(bounced, normal, tangential), swung(p, start, v));
    return out;
  }

  const ClothStep& step_;
  std::span<ClothLevel> levels_;
  ClothLevel& level_;
  MutablePointers r_, end_, velocity_;
  Flesh flesh_;
  Start next_;
};

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

// The half spaces of a row; returns whether any point has one.
HWY_INLINE void takeFlesh(const ClothStep& step, ClothLevel& level, int j, Index k) {
  const D d;
  const PointSurroundings& around = *step.inputs->surroundings;
  const Index column = step.layout->row(j) + 2 * k, at = level.rowStart(j) + k;
  const Pair normal = pairOfColumns(around.normal, column);
  const V zero = hn::Zero(d);
  const auto any = hn::Or(hn::Gt(dot(normal.even, normal.even), zero),
                          hn::Gt(dot(normal.odd, normal.odd), zero));
  if (hn::AllFalse(d, any) && k % ClothLevel::kBlock == 0 && hn::Lanes(d) == ClothLevel::kBlock)
    return;
  if (!hn::AllFalse(d, any))
    level.near[static_cast<Index>(j) * level.blocks() + k / ClothLevel::kBlock] = 1;
  const Pair flesh = pairOfColumns(around.fleshVelocity, column);
  V even, odd;
  hn::LoadInterleaved2(d, around.offset.data() + column, even, odd);
  setPair(pointers(level.normal), at, level.half, normal);
  hn::StoreU(even, d, level.offset.data() + at);
  hn::StoreU(odd, d, level.offset.data() + at + level.half);
  hn::StoreU(dot(normal.even, flesh.even), d, level.rate.data() + at);
  hn::StoreU(dot(normal.odd, flesh.odd), d, level.rate.data() + at + level.half);
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
