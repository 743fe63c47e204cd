#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/deformable/solve/block_cholesky.h>
#include <fascia/deformable/solve/constraint_list.h>

namespace fascia {

// A constraint some of whose rows follow from others, or contradict them.
struct Redundancy {
  std::string constraint;           // its name
  int row_count = 0;                // how many of its rows
  std::vector<std::string> others;  // the names of those they follow from
  // How far what it demands is from what the others leave it, m; 0 but for rounding = no conflict.
  double conflict_m = 0;

  bool contradicts() const;  // by more than rounding
  // "constraint 'loop': 1 row follows from 'hinge a', 'hinge b'", and ", but it wants a place …"
  std::string text() const;
};

// The rows that BlockCholesky left out of J W Jᵀ λ = b. A row left out is a combination of others,
// so that b is solvable only if it is the same combination: N b = 0, a row of N per row left out.
// Where it is not, the constraints conflict, and b gives way to the nearest solvable one,
//     b − Nᵀ (N Nᵀ)⁻¹ N b,
// which spreads the contradiction over all rows concerned (least squares).
class Redundancies {
 public:
  // Allocates. After factorizeAndFindDependent(), of the list's constraints.
  void find(const BlockCholesky& matrix, const ConstraintList& list);
  bool empty() const { return rows_.empty(); }
  void makeSolvable(std::span<Vec3> b) const;
  // With how far the constraints' present values contradict each other.
  std::vector<Redundancy> describe(const ConstraintList& list) const;

 private:
  struct Entry {
    int block;
    Vec3 weights;
  };
  struct Row {
    int block;                   // the constraint that the row left out belongs to
    std::vector<Entry> entries;  // its row of N
  };
  double product(const Row& row, std::span<const Vec3> b) const;

  std::vector<Row> rows_;
  BlockCholesky normal_;  // N Nᵀ, a 3 × 3 block with one entry for each row
  mutable std::vector<Vec3> multipliers_;
};

}  // namespace fascia
