#include <fascia/math/cholesky/panel_kernels.h>

#include <algorithm>
#include <cstddef>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/math/cholesky/panel_kernels.cpp"
#include <hwy/foreach_target.h>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fascia::cholesky {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using D4 = hn::CappedTag<float, 4>;

constexpr int kTile = 16;  // rows: one vector of AVX-512, two of AVX2
constexpr int kHalf = 8;   // what tiles start at a multiple of, and the last one may have

// How far ahead values are fetched, in floats: hardware does not look beyond a page, nor past the
// rows that are gathered between panels.
constexpr std::ptrdiff_t kAhead = 512;

// Vectors for tiles of so many rows.
template <int kRows>
using Tag = hn::CappedTag<float, kRows>;
template <int kRows>
using V = hn::Vec<Tag<kRows>>;
template <int kRows>
constexpr int lanes() {
  return static_cast<int>(hn::MaxLanes(Tag<kRows>()));
}

// Right sides as one array each, `stride` apart.
struct Arrays {
  float* data;
  std::ptrdiff_t stride;
  HWY_INLINE float* of(int side) const { return data + side * stride; }
};

// Where a row of the solution is, with one right side or three.
template <int kSides>
constexpr int kFloats = kSides == 1 ? 1 : 4;
template <int kSides>
HWY_INLINE std::ptrdiff_t place(int row) {
  return kFloats<kSides> * static_cast<std::ptrdiff_t>(row);
}

HWY_INLINE int padded(int height, int rows) {
  return (height + rows - 1) / rows * rows;
}

// Takes the panel's own rows out of the solution.
template <int kSides>
HWY_INLINE void takeOwn(const PanelView& panel, float* x, Arrays own) {
  float* first = x + place<kSides>(panel.rows[0]);
  for (int c = 0; c < panel.width; ++c)
    for (int s = 0; s < kSides; ++s) own.of(s)[c] = first[kFloats<kSides> * c + s];
  std::fill_n(first, kFloats<kSides> * panel.width, 0.0f);
}

// sums += a tile times own rows.
template <int kSides, int kRows>
HWY_INLINE void tileTimesOwn(const float* HWY_RESTRICT tile, int columns, Arrays own, int column,
                             Arrays sums, int row) {
  constexpr int kLanes = lanes<kRows>(), kVectors = kRows / kLanes;
  const Tag<kRows> d;
  V<kRows> sum[kSides][kVectors];
  for (int s = 0; s < kSides; ++s)
    for (int k = 0; k < kVectors; ++k) sum[s][k] = hn::LoadU(d, sums.of(s) + row + k * kLanes);
  for (int c = 0; c < columns; ++c)
    for (int k = 0; k < kVectors; ++k) {
      const V<kRows> m = hn::LoadU(d, tile + c * kRows + k * kLanes);
      hwy::Prefetch(tile + c * kRows + k * kLanes + kAhead);
      for (int s = 0; s < kSides; ++s)
        sum[s][k] = hn::MulAdd(m, hn::Set(d, own.of(s)[column + c]), sum[s][k]);
    }
  for (int s = 0; s < kSides; ++s)
    for (int k = 0; k < kVectors; ++k) hn::StoreU(sum[s][k], d, sums.of(s) + row + k * kLanes);
}

// A block of columns times own rows; returns where its values end.
template <int kSides>
HWY_INLINE const float* blockTimesOwn(const float* values, int columns, int height, Arrays own,
                                      int column, Arrays sums) {
  int row = column;
  for (; height - row > kHalf; row += kTile, values += kTile * columns)
    tileTimesOwn<kSides, kTile>(values, columns, own, column, sums, row);
  if (row < height) {
    tileTimesOwn<kSides, kHalf>(values, columns, own, column, sums, row);
    values += kHalf * columns;
  }
  return values;
}

// Adds the sums to the panel's rows of the solution.
template <int kSides>
HWY_INLINE void scatter(const PanelView& panel, Arrays sums, float* x) {
  if constexpr (kSides == 1) {
    for (int i = 0; i < panel.height; ++i) x[panel.rows[i]] += sums.data[i];
  } else {
    const Tag<kTile> d;
    const D4 d4;
    constexpr int kLanes = lanes<kTile>();
    HWY_ALIGN float packed[4 * kLanes];
    for (int row = 0; row < panel.height; row += kLanes) {
      hn::StoreInterleaved4(hn::Load(d, sums.of(0) + row), hn::Load(d, sums.of(1) + row),
                            hn::Load(d, sums.of(2) + row), hn::Zero(d), d, packed);
      const int count = std::min(kLanes, panel.height - row);
      for (int r = 0; r < count; ++r) {
        float* to = x + place<kSides>(panel.rows[row + r]);
        for (int i = 0; i < 4; i += static_cast<int>(hn::Lanes(d4)))
          hn::Store(hn::Add(hn::Load(d4, to + i), hn::Load(d4, packed + 4 * r + i)), d4, to + i);
      }
    }
  }
}

template <int kSides>
HWY_INLINE void forward(const PanelView& panel, float* x, float* memory) {
  const std::ptrdiff_t stride = padded(panel.height, kTile);
  const Arrays sums = {memory, stride}, own = {memory + kSides * stride, stride};
  takeOwn<kSides>(panel, x, own);
  std::fill_n(memory, kSides * stride, 0.0f);
  const float* values = panel.values;
  int column = 0;
  for (; column + kBlock <= panel.width; column += kBlock)
    values = blockTimesOwn<kSides>(values, kBlock, panel.height, own, column, sums);
  if (column < panel.width)
    blockTimesOwn<kSides>(values, panel.width - column, panel.height, own, column, sums);
  scatter<kSides>(panel, sums, x);
}

// The panel's rows of the solution, as arrays padded with zeros.
template <int kSides>
HWY_INLINE Arrays gather(const PanelView& panel, const float* x, float* memory) {
  const int stride = padded(panel.height, kTile);
  if constexpr (kSides == 1) {
    for (int i = 0; i < panel.height; ++i) memory[i] = x[panel.rows[i]];
    std::fill(memory + panel.height, memory + stride, 0.0f);
  } else {
    const Tag<kTile> d;
    const D4 d4;
    float* packed = memory + 3 * static_cast<std::ptrdiff_t>(stride);
    for (int i = 0; i < panel.height; ++i)
      for (int k = 0; k < 4; k += static_cast<int>(hn::Lanes(d4)))
        hn::Store(hn::Load(d4, x + place<kSides>(panel.rows[i]) + k), d4, packed + 4 * i + k);
    std::fill(packed + 4 * panel.height, packed + 4 * stride, 0.0f);
    for (int i = 0; i < stride; i += lanes<kTile>()) {
      V<kTile> a, b, c, none;
      hn::LoadInterleaved4(d, packed + 4 * i, a, b, c, none);
      hn::Store(a, d, memory + i);
      hn::Store(b, d, memory + stride + i);
      hn::Store(c, d, memory + 2 * stride + i);
    }
  }
  return {memory, stride};
}

// Sums of the lanes of each of four vectors, added to `sums`.
#if HWY_TARGET == HWY_SCALAR
template <int kRows>
HWY_INLINE void addLanes(const V<kRows>* v, float* sums) {
  for (int i = 0; i < 4; ++i) sums[i] += hn::GetLane(v[i]);
}
#else
template <class DN>
HWY_INLINE hn::Vec<D4> foldToFour(DN /*d*/, hn::Vec<DN> v) {
  if constexpr (hn::MaxLanes(DN()) <= 4) {
    return v;
  } else {
    const hn::Half<DN> half;
    return foldToFour(half, hn::Add(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}
template <int kRows>
HWY_INLINE void addLanes(const V<kRows>* v, float* sums) {
  const Tag<kRows> d;
  const auto even = hn::Add(hn::InterleaveLower(d, v[0], v[2]), hn::InterleaveUpper(d, v[0], v[2]));
  const auto odd = hn::Add(hn::InterleaveLower(d, v[1], v[3]), hn::InterleaveUpper(d, v[1], v[3]));
  const auto all = hn::Add(hn::InterleaveLower(d, even, odd), hn::InterleaveUpper(d, even, odd));
  const D4 d4;
  hn::Store(hn::Add(hn::Load(d4, sums), foldToFour(d, all)), d4, sums);
}
#endif

// kColumns columns times the gathered rows of `tiles` tiles from `row` on. Sums per column.
template <int kSides, int kColumns, int kRows>
HWY_INLINE void columnsTimesRows(const float* HWY_RESTRICT values, int tiles, Arrays rows, int row,
                                 float (&sums)[kSides][kBlock]) {
  constexpr int kLanes = lanes<kRows>(), kSlots = (kColumns + 3) / 4 * 4;
  const Tag<kRows> d;
  V<kRows> sum[kSides][kSlots];
  for (auto& side : sum)
    for (auto& v : side) v = hn::Zero(d);
  for (int t = tiles - 1; t >= 0; --t) {
    const float* tile = values + static_cast<std::ptrdiff_t>(t) * kRows * kColumns;
    for (int k = 0; k < kRows; k += kLanes) {
      V<kRows> at[kSides];
      for (int s = 0; s < kSides; ++s) at[s] = hn::LoadU(d, rows.of(s) + row + t * kRows + k);
      for (int c = 0; c < kColumns; ++c) {
        const V<kRows> m = hn::LoadU(d, tile + c * kRows + k);
        hwy::Prefetch(tile + c * kRows + k - kAhead);
        for (int s = 0; s < kSides; ++s) sum[s][c] = hn::MulAdd(m, at[s], sum[s][c]);
      }
    }
  }
  for (int s = 0; s < kSides; ++s)
    for (int c = 0; c < kSlots; c += 4) addLanes<kRows>(sum[s] + c, sums[s] + c);
}

// A block of columns times the gathered rows, into the solution. Values end where those of the next
// block start; returns where they start.
template <int kSides, int kColumns>
HWY_INLINE const float* blockTimesRows(const float* end, int height, Arrays rows, int column,
                                       float* own) {
  HWY_ALIGN float sums[kSides][kBlock] = {};
  const int tiles = (height - column + kHalf - 1) / kTile;
  if (const int row = column + tiles * kTile; row < height) {
    end -= kHalf * kColumns;
    columnsTimesRows<kSides, kColumns, kHalf>(end, 1, rows, row, sums);
  }
  end -= static_cast<std::ptrdiff_t>(tiles) * kTile * kColumns;
  columnsTimesRows<kSides, kColumns, kTile>(end, tiles, rows, column, sums);
  for (int c = 0; c < kColumns; ++c)
    for (int s = 0; s < kSides; ++s) own[kFloats<kSides> * (column + c) + s] = sums[s][c];
  return end;
}

// From the last value to the first: panels are visited in that order, too.
template <int kSides>
HWY_INLINE void backward(const PanelView& panel, float* x, float* memory) {
  const Arrays rows = gather<kSides>(panel, x, memory);
  float* own = x + place<kSides>(panel.rows[0]);
  const float* end = panel.end;
  const int height = panel.height, last = panel.width / kBlock * kBlock;
  switch (panel.width - last) {
    case 7:
      end = blockTimesRows<kSides, 7>(end, height, rows, last, own);
      break;
    case 6:
      end = blockTimesRows<kSides, 6>(end, height, rows, last, own);
      break;
    case 5:
      end = blockTimesRows<kSides, 5>(end, height, rows, last, own);
      break;
    case 4:
      end = blockTimesRows<kSides, 4>(end, height, rows, last, own);
      break;
    case 3:
      end = blockTimesRows<kSides, 3>(end, height, rows, last, own);
      break;
    case 2:
      end = blockTimesRows<kSides, 2>(end, height, rows, last, own);
      break;
    case 1:
      end = blockTimesRows<kSides, 1>(end, height, rows, last, own);
      break;
    default:
      break;
  }
  for (int c = last - kBlock; c >= 0; c -= kBlock)
    end = blockTimesRows<kSides, kBlock>(end, height, rows, c, own);
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

namespace {

// Calls use(column, columns, row, rows) for each tile, as they follow each other.
template <class Use>
void forTiles(int width, int height, const Use& use) {
  for (int column = 0; column < width; column += kBlock)
    for (int row = column; row < height; row += 16)
      use(column, std::min(kBlock, width - column), row, height - row > 8 ? 16 : 8);
}

}  // namespace

std::size_t panelSize(int width, int height) {
  std::size_t floats = 0;
  forTiles(width, height, [&](int, int columns, int, int rows) {
    floats += static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  });
  return floats;
}

std::size_t panelMemory(int height) {
  return 7 * static_cast<std::size_t>((height + 15) / 16 * 16);
}

void packPanel(int width, int height, const double* columns, float* values) {
  forTiles(width, height, [&](int column, int count, int row, int rows) {
    for (int c = column; c < column + count; ++c)
      for (int r = row; r < row + rows; ++r)
        *values++ = r < height
                        ? static_cast<float>(columns[static_cast<std::ptrdiff_t>(c) * height + r])
                        : 0.0f;
  });
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
