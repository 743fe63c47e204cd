#include <fascia/skin/grid/grid_kernels.h>

#include <algorithm>
#include <array>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/grid/grid_kernels.cpp"
#include <hwy/foreach_target.h>

#include <fascia/skin/point/point_step-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

// What a row of cells does to its four corners, per column: to the point itself, to its right
// neighbour, and one row up to the point above and to the one above right. `below` is the sum of
// what the previous row of cells did to this row.
struct CellForces {
  MutablePointers self, right, up, upRight, below;
  CellForces(float* scratch, std::size_t stride) {
    MutablePointers* all[] = {&self, &right, &up, &upRight, &below};
    for (std::size_t q = 0; q < 5; ++q) {
      float* base = scratch + 3 * q * stride + GridLayout::kPad;
      *all[q] = {base, base + stride, base + 2 * stride};
    }
  }
  // A force on a right neighbour of the last column lands on the first one.
  void wrap(int columns) const {
    for (const MutablePointers& p : {right, upRight})
      for (float* a : {p.x, p.y, p.z}) a[-1] = a[columns - 1];
  }
  HWY_INLINE V3 onPoint(std::size_t i) const {
    return below.at(i) + (self.at(i) + right.at(i - 1));
  }
  HWY_INLINE void passUp(std::size_t i) const { below.set(i, up.at(i) + upRight.at(i - 1)); }
};

// The cells between a row (coefficients from `c`, positions p from element 0) and the next row n.
template <bool kHasNext>
HWY_INLINE void cellRow(const ElasticGrid::Coefficients& c, std::size_t row, int columns,
                        Pointers p, Pointers n, const CellForces& out) {
  const D d;
  const std::size_t lanes = hn::Lanes(d), count = static_cast<std::size_t>(columns);
  const V cap = hn::Set(d, c.cap), quarter = hn::Set(d, 0.25f);
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto load = [&](const FloatArray& a)
                          HWY_ATTR { return hn::LoadU(d, a.data() + row + i); };
    const V3 a = p.at(i);
    const V3 e1 = p.at(i + 1) - a;
    const V g1 = load(c.g1);
    const V t1 = clampAbs(hn::Sub(dot(e1, e1), g1), hn::Mul(cap, g1));
    const V3 q1 = scaled(hn::Mul(load(c.w1), t1), e1);
    if constexpr (!kHasNext) {
      out.self.set(i, q1);
      out.right.set(i, scaled(hn::Set(d, -1.f), q1));
    } else {
      const V3 up = n.at(i);
      const V3 e2 = up - a, e1Up = n.at(i + 1) - up;
      const V g2 = load(c.g2);
      const V t2 = clampAbs(hn::Sub(dot(e2, e2), g2), hn::Mul(cap, g2));
      const V3 q2 = scaled(hn::Mul(load(c.w2), t2), e2);
      const V3 s1 = e1 + e1Up;                // 2 s1
      const V3 s2 = (e2 + e2) + (e1Up - e1);  // 2 s2: e2 + (e2 + e1Up − e1)
      const V t12 = clampAbs(hn::MulSub(quarter, dot(s1, s2), load(c.g12)), load(c.lim12));
      const V stress = hn::Mul(quarter, hn::Mul(load(c.w12), t12));
      const V3 sum = scaled(stress, s1 + s2), difference = scaled(stress, s2 - s1);
      out.self.set(i, (q1 + q2) + sum);
      out.right.set(i, scaled(hn::Set(d, -1.f), q1 + difference));
      out.up.set(i, difference - q2);
      out.upRight.set(i, scaled(hn::Set(d, -1.f), sum));
    }
  }
}

// Calls apply(j, i, force) for every vector of columns of rows [rowBegin, rowEnd) with the membrane
// forces on them, and endRow(j) after each row. positionRow(j) gives a row's positions; it may be
// overwritten by apply, because a row's cells are finished before the row is.
template <class PositionRow, class Apply, class EndRow>
HWY_INLINE void forEachForce(const GridLayout& g, const ElasticGrid::Coefficients& c, int rowBegin,
                             int rowEnd, float* scratch, const PositionRow& positionRow,
                             const Apply& apply, const EndRow& endRow) {
  const CellForces cells(scratch, g.stride());
  const D d;
  const std::size_t lanes = hn::Lanes(d), count = static_cast<std::size_t>(g.columns);
  const V3 zero{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  if (rowBegin > 0) {
    cellRow<true>(c, g.row(rowBegin - 1), g.columns, positionRow(rowBegin - 1),
                  positionRow(rowBegin), cells);
    cells.wrap(g.columns);
  }
  for (std::size_t i = 0; i < count; i += lanes)
    rowBegin > 0 ? cells.passUp(i) : cells.below.set(i, zero);
  for (int j = rowBegin; j < rowEnd; ++j) {
    if (j + 1 < g.rows)
      cellRow<true>(c, g.row(j), g.columns, positionRow(j), positionRow(j + 1), cells);
    else
      cellRow<false>(c, g.row(j), g.columns, positionRow(j), positionRow(j), cells);
    cells.wrap(g.columns);
    for (std::size_t i = 0; i < count; i += lanes) {
      apply(j, i, cells.onPoint(i));
      cells.passUp(i);
    }
    endRow(j);
  }
}

void gridForcesImpl(const GridLayout& g, const ElasticGrid::Coefficients& c,
                    const VectorArray& position, VectorArray& force, float* scratch) {
  const MutablePointers out = pointers(force);
  const Pointers in = pointers(position);
  forEachForce(
      g, c, 0, g.rows, scratch,
      [&](int j) {
        return Pointers{in.x + g.row(j), in.y + g.row(j), in.z + g.row(j)};
      },
      [&](int j, std::size_t i, V3 f) HWY_ATTR { out.set(g.row(j) + i, f); },
      [&](int j) {
        for (float* a : {out.x, out.y, out.z})
          std::fill(a + g.row(j) + g.columns, a + g.row(j) + g.stride() - GridLayout::kPad, 0.f);
      });
}

void sweepRowsImpl(const SweepModel& m, const SweepBand& band, int rowBegin, int rowEnd,
                   float time_s, float* scratch) {
  const GridLayout& g = *m.layout;
  const auto local = [&](int j) {
    return static_cast<std::size_t>(j - band.firstStored) * g.stride() + GridLayout::kPad;
  };
  const MutablePointers r{band.position[0], band.position[1], band.position[2]};
  const MutablePointers v{band.velocity[0], band.velocity[1], band.velocity[2]};
  const PointStep step{m.inputs, time_s};
  forEachForce(
      g, *m.elastic, rowBegin, rowEnd, scratch,
      [&](int j) {
        return Pointers{r.x + local(j), r.y + local(j), r.z + local(j)};
      },
      [&](int j, std::size_t i, V3 f) HWY_ATTR { step(g.row(j) + i, f, r, v, local(j) + i); },
      [&](int j) {
        for (float* a : {r.x + local(j), r.y + local(j), r.z + local(j)}) {
          a[-1] = a[g.columns - 1];
          a[g.columns] = a[0];
        }
      });
}

void gridNormalsImpl(const GridLayout& g, const VectorArray& position, int rowBegin, int rowEnd,
                     VectorArray& normal) {
  const D d;
  const std::size_t lanes = hn::Lanes(d), count = static_cast<std::size_t>(g.columns);
  const Pointers r = pointers(position);
  const MutablePointers out = pointers(normal);
  for (int j = rowBegin; j < rowEnd; ++j) {
    const std::size_t row = g.row(j), low = g.row(std::max(j - 1, 0));
    const std::size_t high = g.row(std::min(j + 1, g.rows - 1));
    for (std::size_t i = 0; i < count; i += lanes) {
      // Position pads repeat the row's other end also on open grids, where one-sided differences
      // would be exact; the border of a sheet is pinned or rarely touches anything.
      const V3 u = r.at(row + i + 1) - r.at(row + i - 1);
      const V3 w = r.at(high + i) - r.at(low + i);
      const V3 n = cross(u, w);
      const V squared = dot(n, n);
      const V inverse = hn::IfThenElseZero(hn::Gt(squared, hn::Set(d, 1e-30f)),
                                           inverseRoot(hn::Max(squared, hn::Set(d, 1e-30f))));
      out.set(row + i, scaled(inverse, n));
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(gridForcesImpl);
HWY_EXPORT(sweepRowsImpl);
HWY_EXPORT(gridNormalsImpl);

void SweepScratch::resize(const GridLayout& layout) {
  floats_.assign(15 * layout.stride() + 16, 0.f);
}

void gridForces(const GridLayout& layout, const ElasticGrid::Coefficients& elastic,
                const VectorArray& position, VectorArray& force, SweepScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(gridForcesImpl)(layout, elastic, position, force, scratch.data());
}

void sweepRows(const SweepModel& model, const SweepBand& band, int rowBegin, int rowEnd,
               float time_s, SweepScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(sweepRowsImpl)(model, band, rowBegin, rowEnd, time_s, scratch.data());
}

void gridNormals(const GridLayout& layout, const VectorArray& position, int rowBegin, int rowEnd,
                 VectorArray& normal) {
  HWY_DYNAMIC_DISPATCH(gridNormalsImpl)(layout, position, rowBegin, rowEnd, normal);
}

}  // namespace fascia
#endif
