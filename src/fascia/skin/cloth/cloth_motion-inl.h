// How the finest level of cloth moves, as SIMD lanes: where points are when a step begins, what
// ends it, and what goes down to the coarser levels. Included once per Highway target.
#if defined(FASCIA_SKIN_CLOTH_MOTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_SKIN_CLOTH_MOTION_INL_H_
#undef FASCIA_SKIN_CLOTH_MOTION_INL_H_
#else
#define FASCIA_SKIN_CLOTH_MOTION_INL_H_
#endif

#include <algorithm>

#include <fascia/skin/cloth/cloth_rows-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

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

// The half spaces of a row's points from column pair k on.
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

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#endif  // include guard, toggled per target
