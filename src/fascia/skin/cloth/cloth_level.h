#pragma once

#include <cstdint>
#include <vector>

#include <fascia/base/aligned.h>

namespace fascia {

// One level of a sheet that is stepped by limits (cloth_stepper.h), as its kernels need it.
//
// A row lies in memory as its even columns, then its odd ones: edges within the row join two
// vectors without a shuffle, and the even columns are the next coarser level's row as it is.
struct ClothLevel {
  static constexpr std::size_t kBlock = 16;  // floats; the widest vector

  struct Limit {
    float first = 0, second = 0;  // share of the excess that each end goes
    float length_m = 0;
  };
  // What is the same for the edges of a row. Offsets into `tables`; each leads to lists of `half`
  // floats. Rows that have the same numbers share them: those of an even sheet stay in the cache.
  struct Row {
    // Edges from column 2k to 2k + 1: share of the excess that the first end goes, that the second
    // goes, longest length (m); the same three of those from 2k + 1 to 2k + 2.
    std::size_t inside = 0;
    // Edges to the next row, even columns, then odd ones: share of this row's end, of the other's,
    // length.
    std::size_t above = 0;
    // Diagonals of the cells up to the next row, cells from even columns, then from odd ones; each
    // up to the right, then up to the left: share of the lower end, of the upper one, length.
    std::size_t shear = 0;
    // Of a tube, from its last column to its first: the edge, and the diagonals to the next row.
    Limit seam, seamUp, seamDown;
    // The coarser level's row at or before this one, the share of the one after it, and which of
    // its rows this is (-1: none).
    int coarser = 0, onCoarser = -1;
    float share = 0;
  };

  int columns = 0, rows = 0;
  bool closed = false;
  std::size_t half = 0;       // floats from a row's even columns to its odd ones
  bool extraColumn = false;   // the last column is the finer level's last odd one
  std::vector<Row> row;       // constant, as all that follows up to `place`
  std::vector<int> finerRow;  // of the next finer level
  FloatArray tables;
  FloatArray oddShare;  // by odd column: share of the coarser column after it
  VectorArray place;    // m
  VectorArray change;   // by columns in order: what this level's sweeps did to `place`, m
  // Half spaces as in PointSurroundings, where `near` says that a block of a row has any.
  VectorArray normal;
  FloatArray offset, rate;  // m, m/s
  std::vector<std::uint8_t> near;

  std::size_t evens() const { return (static_cast<std::size_t>(columns) + 1) / 2; }
  std::size_t odds() const { return static_cast<std::size_t>(columns) / 2; }
  std::size_t stride() const { return 2 * half; }
  std::size_t rowStart(int j) const { return static_cast<std::size_t>(j) * stride(); }
  std::size_t at(int i, int j) const {
    const auto column = static_cast<std::size_t>(i);
    return rowStart(j) + (column % 2) * half + column / 2;
  }
  std::size_t storage() const { return static_cast<std::size_t>(rows) * stride() + kBlock; }
  // Blocks of one row's even columns; block b of a row also holds its odd ones.
  std::size_t blocks() const { return (evens() + kBlock - 1) / kBlock; }

  // Room for a level of that many points, nothing near.
  void resize(int columnCount, int rowCount, bool isClosed) {
    columns = columnCount, rows = rowCount, closed = isClosed;
    half = (blocks() + 1) * kBlock;
    row.resize(static_cast<std::size_t>(rows));
    for (VectorArray* a : {&place, &change, &normal}) *a = VectorArray(storage());
    for (FloatArray* a : {&offset, &rate}) a->assign(storage(), 0.f);
    near.assign(static_cast<std::size_t>(rows) * blocks(), 0);
    oddShare.assign(half, 0.5f);
  }
};

}  // namespace fascia
