#pragma once

#include <span>
#include <utility>
#include <vector>

#include <fascia/math/types.h>

namespace fascia {

// L D Lᵀ of a symmetric matrix of 3 × 3 blocks that is nowhere negative, and solutions with it.
// Blocks are ordered for little fill (minimum degree), so that chains and trees cost
// time and memory in proportion to their length. Rows that depend on earlier ones are left out of
// the factorisation, and known by number.
class BlockCholesky {
 public:
  using Block = Mat3;
  using Vector = std::vector<Vec3>;

  // Blocks (i, j), i ≠ j, of the lower or upper triangle; diagonal ones always exist. Allocates
  // everything that is needed later.
  void setPattern(std::size_t blockCount, std::span<const std::pair<int, int>> offDiagonal);
  std::size_t blockCount() const { return order_.size(); }
  std::size_t fillCount() const { return rows_.size(); }  // blocks of L below the diagonal

  void setZero();
  // Adds to block (i, j); (j, i) is its transpose and must not be added too. The block must be in
  // the pattern. Padding of rows that are not there: 1 on the diagonal, 0 elsewhere.
  void add(int i, int j, const Block& value);

  // Which rows of a block to leave out; row r of block i is bit r of dropped[i].
  using RowMask = std::vector<unsigned char>;
  // Leaves out rows whose pivot is below `tolerance` of their diagonal entry: those that are
  // combinations of others.
  void factorizeAndFindDependent(double tolerance);
  // Leaves out the same rows again, whatever the numbers are now. False if a pivot is not positive.
  [[nodiscard]] bool factorize();
  const RowMask& dropped() const { return dropped_; }
  void setDropped(std::size_t block, unsigned char rows) { dropped_[block] = rows; }

  // x ← A⁻¹ x, 0 in rows left out.
  void solve(std::span<Vec3> x) const;
  // For a row left out: n with nᵀ A = 0 and n = 1 in that row, 0 in all others left out.
  void dependence(int block, int row, std::span<Vec3> n) const;

 private:
  struct Pivot {
    Mat3 lower;           // unit lower triangle
    Vec3 inverse;         // 1/d; 0 for rows left out
    Mat3 inverseOfBlock;  // lower⁻ᵀ diag(inverse) lower⁻¹
  };
  std::size_t slot(int row, int column) const;  // of L, in the new order
  static Pivot pivotOf(const Mat3& diagonal, unsigned char dropped);
  bool eliminate(bool find, double tolerance);
  void updateBelow(std::size_t column);

  std::vector<int> order_, place_;        // new → given number, and back
  std::vector<std::size_t> columnFirst_;  // n + 1: where a column's blocks begin
  std::vector<int> rows_;                 // of each block of L, rising within a column
  std::vector<Mat3> blocks_, diagonal_;   // A, then L and what D is made of
  std::vector<Vec3> diagonalEntries_;     // of A, to compare pivots with
  std::vector<Pivot> pivots_;
  RowMask dropped_;                 // by given number
  mutable std::vector<Vec3> work_;  // in the new order
};

}  // namespace fascia
