#pragma once

#include <cstddef>

namespace fascia {

// How an M x N grid of points lies in memory: row after row, each row padded on both sides so that
// SIMD loads may reach one point beyond it. The pads of position arrays repeat the row's other end,
// which closes the tube without a branch in any kernel; an open grid (a sheet) uses the same pads
// with zero stiffness across them.
struct GridLayout {
  static constexpr int kPad = 16;  // floats; the widest vector, so that rows stay aligned

  int columns = 0;  // around
  int rows = 0;     // from the bottom end to the top end
  bool closed = true;

  std::size_t stride() const {
    return static_cast<std::size_t>((columns + kPad - 1) / kPad * kPad + 2 * kPad);
  }
  std::size_t row(int j) const { return static_cast<std::size_t>(j) * stride() + kPad; }
  std::size_t at(int i, int j) const { return row(j) + static_cast<std::size_t>(i); }
  std::size_t storage() const { return static_cast<std::size_t>(rows) * stride() + kPad; }
  std::size_t pointCount() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  int wrapped(int i) const { return i < 0 ? i + columns : i >= columns ? i - columns : i; }
};

// visit(i, j, storage index), row by row.
template <class Visit>
void forEachGridPoint(const GridLayout& g, const Visit& visit) {
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i) visit(i, j, g.at(i, j));
}

}  // namespace fascia
