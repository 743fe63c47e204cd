#pragma once

#include <cstddef>

namespace fascia::cholesky {

// SIMD kernels of a solve; dispatched at run time.

// Columns that are swept together: with three right sides, what AVX-512 has registers for.
inline constexpr int kBlock = 8;

// A supernode, ready to be solved with. With its triangle T and the rectangle R below, L = [T; R],
// it stores M = [T⁻¹; -R T⁻¹] (a partitioned inverse, Alvarado & Schreiber 1993), so that both
// sweeps are products with M and nothing waits for the result of a division:
//   forward  x_own ← T⁻¹ x_own and x_below += -R T⁻¹ x_own, all of them from the x_own before,
//   backward x_own ← Mᵀ [x_own; x_below].
// Values lie in the order in which both sweeps read them: by blocks of columns; each block by tiles
// of 16 rows (the last one has 8 if that is enough), from the block's own rows on; each tile column
// by column, padded with zeros.
struct PanelView {
  const float *values = nullptr, *end = nullptr;
  const int* rows = nullptr;  // of the solution: own rows first, then those below
  int width = 0, height = 0;  // height: own rows and those below, without pads
};

// Floats that a panel of this width and height stores.
std::size_t panelSize(int width, int height);
// Writes the values of a panel from its columns in full, top to bottom, one after the other.
void packPanel(int width, int height, const double* columns, float* values);
// Floats of working memory that the sweeps need for a panel of this height.
std::size_t panelMemory(int height);

// One right side: x has a float per row.
void forwardOne(const PanelView& panel, float* x, float* memory);
void backwardOne(const PanelView& panel, float* x, float* memory);
// Three: x has four floats per row, the last one 0; aligned like SIMD arrays.
void forwardThree(const PanelView& panel, float* x, float* memory);
void backwardThree(const PanelView& panel, float* x, float* memory);

}  // namespace fascia::cholesky
