#pragma once

#include <cstddef>

namespace fascia::cholesky {

// SIMD kernels of a solve; dispatched at run time.

// Panels are cut into tiles of this many rows, the last one padded with zeros: one vector of
// AVX-512, two of AVX2.
inline constexpr int kTileRows = 16;

// A supernode, ready to be solved with. With its triangle T and the rectangle R below, L = [T; R],
// it stores M = [T⁻¹; -R T⁻¹] (a partitioned inverse, Alvarado & Schreiber 1993), so that both
// sweeps are products with M and nothing waits for the result of a division:
//   forward  x_own ← T⁻¹ x_own and x_below += -R T⁻¹ x_own, all of them from the x_own before,
//   backward x_own ← Mᵀ [x_own; x_below].
// Tiles follow each other, each column by column. Those of the triangle end at its last column that
// is not zero: a tile k has min(width, 16 (k + 1)) columns.
struct PanelView {
  const float* values = nullptr;
  const int* rows = nullptr;  // of the solution: own rows first, then those below
  int width = 0, height = 0;  // height: own rows and those below, without pads
};

// Floats that a panel of this width and height stores.
std::size_t panelSize(int width, int height);
// Floats of working memory that the sweeps need for a panel of this height.
std::size_t panelMemory(int height);

// One right side: x has a float per row.
void forwardOne(const PanelView& panel, float* x, float* memory);
void backwardOne(const PanelView& panel, float* x, float* memory);
// Three: x has four floats per row, the last one 0; aligned like SIMD arrays.
void forwardThree(const PanelView& panel, float* x, float* memory);
void backwardThree(const PanelView& panel, float* x, float* memory);

}  // namespace fascia::cholesky
