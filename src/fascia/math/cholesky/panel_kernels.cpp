#include <fascia/math/cholesky/panel_kernels.h>

#include <algorithm>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/math/cholesky/panel_kernels.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fascia::cholesky {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, kTileRows>;
using D4 = hn::CappedTag<float, 4>;
using V = hn::Vec<D>;

constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
constexpr int kVectors = kTileRows / kLanes;     // of a tile
constexpr int kTogether = kVectors > 1 ? 2 : 1;  // vectors of rows that share a broadcast
constexpr int kBlock = 4;                        // columns that are swept together going backward

// Right sides are `kSides` arrays, `stride` apart.
struct Arrays {
  float* data;
  std::ptrdiff_t stride;
  HWY_INLINE float* of(int side) const { return data + side * stride; }
};

HWY_INLINE int tileColumns(int tile, int width) {
  return std::min(width, kTileRows * (tile + 1));
}

// to += from, for a row of the solution.
template <int kSides>
HWY_INLINE void addRow(const float* from, float* to) {
  if constexpr (kSides == 1) {
    *to += *from;
  } else {
    const D4 d;
    for (std::size_t i = 0; i < 4; i += hn::Lanes(d))
      hn::Store(hn::Add(hn::Load(d, to + i), hn::Load(d, from + i)), d, to + i);
  }
}

// Takes the panel's own rows out of the solution.
template <int kSides>
HWY_INLINE void takeOwn(const PanelView& panel, float* x, Arrays own) {
  constexpr int kFloats = kSides == 1 ? 1 : 4;
  float* first = x + kFloats * static_cast<std::ptrdiff_t>(panel.rows[0]);
  for (int c = 0; c < panel.width; ++c)
    for (int s = 0; s < kSides; ++s) own.of(s)[c] = first[kFloats * c + s];
  std::fill_n(first, kFloats * panel.width, 0.0f);
}

// Rows [first, first + kTogether vectors) of a tile times the own rows; the sums lie like the
// solution: side by side for three right sides.
template <int kSides>
HWY_INLINE void tileTimesOwn(const float* HWY_RESTRICT tile, int columns, Arrays own,
                             float* HWY_RESTRICT sums) {
  const D d;
  V sum[2][kSides][kTogether];
  for (auto& half : sum)
    for (auto& side : half)
      for (V& v : side) v = hn::Zero(d);
  int c = 0;
  // Two sums each: one would wait for its own additions.
  for (; c + 2 <= columns; c += 2)
    for (int odd = 0; odd < 2; ++odd)
      for (int k = 0; k < kTogether; ++k) {
        const V m = hn::Load(d, tile + (c + odd) * kTileRows + k * kLanes);
        for (int s = 0; s < kSides; ++s)
          sum[odd][s][k] = hn::MulAdd(m, hn::Set(d, own.of(s)[c + odd]), sum[odd][s][k]);
      }
  for (; c < columns; ++c)
    for (int k = 0; k < kTogether; ++k) {
      const V m = hn::Load(d, tile + c * kTileRows + k * kLanes);
      for (int s = 0; s < kSides; ++s)
        sum[0][s][k] = hn::MulAdd(m, hn::Set(d, own.of(s)[c]), sum[0][s][k]);
    }
  for (int k = 0; k < kTogether; ++k) {
    if constexpr (kSides == 1) {
      hn::Store(hn::Add(sum[0][0][k], sum[1][0][k]), d, sums + k * kLanes);
    } else {
      hn::StoreInterleaved4(
          hn::Add(sum[0][0][k], sum[1][0][k]), hn::Add(sum[0][1][k], sum[1][1][k]),
          hn::Add(sum[0][2][k], sum[1][2][k]), hn::Zero(d), d, sums + 4 * k * kLanes);
    }
  }
}

template <int kSides>
HWY_INLINE void forward(const PanelView& panel, float* x, float* memory) {
  constexpr int kFloats = kSides == 1 ? 1 : 4;
  const Arrays own = {memory, panel.width};
  takeOwn<kSides>(panel, x, own);
  HWY_ALIGN float sums[4 * kTileRows];
  const float* values = panel.values;
  for (int row = 0, tile = 0; row < panel.height; row += kTileRows, ++tile) {
    const int columns = tileColumns(tile, panel.width);
    for (int k = 0; k < kVectors; k += kTogether)
      tileTimesOwn<kSides>(values + k * kLanes, columns, own, sums + kFloats * k * kLanes);
    values += columns * kTileRows;
    const int* rows = panel.rows + row;
    const int count = std::min(kTileRows, panel.height - row);
    for (int r = 0; r < count; ++r)
      addRow<kSides>(sums + kFloats * r, x + kFloats * static_cast<std::ptrdiff_t>(rows[r]));
  }
}

// The panel's rows of the solution, as arrays padded with zeros to whole tiles.
template <int kSides>
HWY_INLINE Arrays gather(const PanelView& panel, const float* x, float* memory) {
  const int padded = (panel.height + kTileRows - 1) / kTileRows * kTileRows;
  if constexpr (kSides == 1) {
    for (int i = 0; i < panel.height; ++i) memory[i] = x[panel.rows[i]];
    std::fill(memory + panel.height, memory + padded, 0.0f);
    return {memory, padded};
  } else {
    const D d;
    const D4 d4;
    float* packed = memory + 3 * static_cast<std::ptrdiff_t>(padded);
    for (int i = 0; i < panel.height; ++i)
      for (std::size_t k = 0; k < 4; k += hn::Lanes(d4))
        hn::Store(hn::Load(d4, x + 4 * static_cast<std::ptrdiff_t>(panel.rows[i]) + k), d4,
                  packed + 4 * i + k);
    std::fill(packed + 4 * panel.height, packed + 4 * padded, 0.0f);
    for (int i = 0; i < padded; i += kLanes) {
      V a, b, c, none;
      hn::LoadInterleaved4(d, packed + 4 * i, a, b, c, none);
      hn::Store(a, d, memory + i);
      hn::Store(b, d, memory + padded + i);
      hn::Store(c, d, memory + 2 * padded + i);
    }
    return {memory, padded};
  }
}

// Sums of the lanes of each of four vectors.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void sumLanes(const V (&v)[kBlock], float* sums) {
  for (int i = 0; i < kBlock; ++i) sums[i] = hn::GetLane(v[i]);
}
#else
template <class DN>
HWY_INLINE hn::Vec<D4> foldToFour(DN d, hn::Vec<DN> v) {
  if constexpr (hn::MaxLanes(DN()) <= 4) {
    return v;
  } else {
    const hn::Half<DN> half;
    return foldToFour(half, hn::Add(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}
HWY_INLINE void sumLanes(const V (&v)[kBlock], float* sums) {
  const D d;
  const V even = hn::Add(hn::InterleaveLower(d, v[0], v[2]), hn::InterleaveUpper(d, v[0], v[2]));
  const V odd = hn::Add(hn::InterleaveLower(d, v[1], v[3]), hn::InterleaveUpper(d, v[1], v[3]));
  const V all = hn::Add(hn::InterleaveLower(d, even, odd), hn::InterleaveUpper(d, even, odd));
  hn::Store(foldToFour(d, all), D4(), sums);
}
#endif

// kColumns columns from `column` on: their products with the gathered rows, into the solution.
template <int kSides, int kColumns>
HWY_INLINE void columnsTimesRows(const PanelView& panel, int column, Arrays rows, float* own) {
  const D d;
  V sum[kSides][kBlock];
  for (auto& side : sum)
    for (V& v : side) v = hn::Zero(d);
  // Tiles above hold nothing of these columns.
  int tile = column / kTileRows;
  const float* values = panel.values + kTileRows * column +
                        kTileRows * kTileRows * static_cast<std::ptrdiff_t>(tile * (tile + 1) / 2);
  for (int row = tile * kTileRows; row < panel.height; row += kTileRows, ++tile) {
    for (int k = 0; k < kTileRows; k += kLanes) {
      V at[kSides];
      for (int s = 0; s < kSides; ++s) at[s] = hn::Load(d, rows.of(s) + row + k);
      for (int c = 0; c < kColumns; ++c) {
        const V m = hn::Load(d, values + c * kTileRows + k);
        for (int s = 0; s < kSides; ++s) sum[s][c] = hn::MulAdd(m, at[s], sum[s][c]);
      }
    }
    values += kTileRows * tileColumns(tile, panel.width);
  }
  HWY_ALIGN float sums[kSides][kBlock];
  for (int s = 0; s < kSides; ++s) sumLanes(sum[s], sums[s]);
  constexpr int kFloats = kSides == 1 ? 1 : 4;
  for (int c = 0; c < kColumns; ++c)
    for (int s = 0; s < kSides; ++s) own[kFloats * (column + c) + s] = sums[s][c];
}

template <int kSides>
HWY_INLINE void backward(const PanelView& panel, float* x, float* memory) {
  constexpr int kFloats = kSides == 1 ? 1 : 4;
  const Arrays rows = gather<kSides>(panel, x, memory);
  float* own = x + kFloats * static_cast<std::ptrdiff_t>(panel.rows[0]);
  int c = 0;
  for (; c + kBlock <= panel.width; c += kBlock)
    columnsTimesRows<kSides, kBlock>(panel, c, rows, own);
  switch (panel.width - c) {
    case 3:
      columnsTimesRows<kSides, 3>(panel, c, rows, own);
      break;
    case 2:
      columnsTimesRows<kSides, 2>(panel, c, rows, own);
      break;
    case 1:
      columnsTimesRows<kSides, 1>(panel, c, rows, own);
      break;
    default:
      break;
  }
}

void forwardOneImpl(const PanelView& panel, float* x, float* memory) {
  forward<1>(panel, x, memory);
}
void backwardOneImpl(const PanelView& panel, float* x, float* memory) {
  backward<1>(panel, x, memory);
}
void forwardThreeImpl(const PanelView& panel, float* x, float* memory) {
  forward<3>(panel, x, memory);
}
void backwardThreeImpl(const PanelView& panel, float* x, float* memory) {
  backward<3>(panel, x, memory);
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia::cholesky
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia::cholesky {

HWY_EXPORT(forwardOneImpl);
HWY_EXPORT(backwardOneImpl);
HWY_EXPORT(forwardThreeImpl);
HWY_EXPORT(backwardThreeImpl);

std::size_t panelSize(int width, int height) {
  std::size_t columns = 0;
  for (int row = 0, tile = 0; row < height; row += kTileRows, ++tile)
    columns += static_cast<std::size_t>(std::min(width, kTileRows * (tile + 1)));
  return kTileRows * columns;
}

std::size_t panelMemory(int height) {
  const int padded = (height + kTileRows - 1) / kTileRows * kTileRows;
  return 7 * static_cast<std::size_t>(padded);
}

void forwardOne(const PanelView& panel, float* x, float* memory) {
  HWY_DYNAMIC_DISPATCH(forwardOneImpl)(panel, x, memory);
}
void backwardOne(const PanelView& panel, float* x, float* memory) {
  HWY_DYNAMIC_DISPATCH(backwardOneImpl)(panel, x, memory);
}
void forwardThree(const PanelView& panel, float* x, float* memory) {
  HWY_DYNAMIC_DISPATCH(forwardThreeImpl)(panel, x, memory);
}
void backwardThree(const PanelView& panel, float* x, float* memory) {
  HWY_DYNAMIC_DISPATCH(backwardThreeImpl)(panel, x, memory);
}

}  // namespace fascia::cholesky
#endif
