#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/math/sparse.h>

namespace fascia {

namespace cholesky {
struct Supernodes;
struct Tasks;
struct PanelView;
}  // namespace cholesky

// Solves A x = b for one symmetric positive definite A and many b: A = L Lᵀ is found once in
// double; L is kept in float, as dense panels of neighbouring columns that SIMD lanes sweep. A
// solve is bound by reading L twice, so that three right sides cost little more than one. Results
// have the same bits on any number of threads.
class SupernodalCholesky {
 public:
  // Working memory of solves, for one thread at a time: grown on first use.
  struct Scratch {
    FloatArray solution, panel;
  };

  // Reads the lower triangle. False if A is not positive definite or not finite; then size() is 0.
  [[nodiscard]] bool factorize(const SparseMatrix& a);

  std::size_t size() const { return order_.size(); }  // rows
  // Of the stored factor, its explicit zeros included.
  std::size_t nonZeros() const { return values_.size(); }

  // Solves A x = b in place; each span has size() entries. Three right sides share a sweep.
  void solve(std::span<float> x, Scratch& scratch) const;
  void solve(std::span<float> x, std::span<float> y, std::span<float> z, Scratch& scratch) const;

 private:
  // A supernode, see PanelView.
  struct Panel {
    std::size_t values = 0, end = 0, rows = 0;  // where they are
    int width = 0, height = 0;
  };
  // Panels [first, end): a subtree whose columns and rows nobody else touches. What it subtracts
  // from rows above waits in a tail of its own, behind the solution.
  struct Subtree {
    int first = 0, end = 0;
    int firstColumn = 0, endColumn = 0;
    int tail = 0;           // where in the solution
    std::size_t above = 0;  // where in above_ its rows start
    int aboveCount = 0;
  };

  void layOut(const cholesky::Supernodes& supernodes, const cholesky::Tasks& tasks);
  void layOutSubtree(const cholesky::Supernodes& supernodes, Subtree& subtree);
  cholesky::PanelView view(int panel) const;
  template <int kSides>
  void solveSides(const std::span<float>* sides, Scratch& scratch) const;
  template <int kSides>
  void sweepForward(const Subtree& subtree, const std::span<float>* sides, float* x,
                    float* memory) const;
  template <int kSides>
  void sweepBackward(const Subtree& subtree, const std::span<float>* sides, float* x,
                     float* memory) const;
  template <int kSides>
  void sweepTop(const std::span<float>* sides, float* x, float* memory) const;

  std::vector<int> order_;  // order_[k]: which row of A is row k of the factor
  std::vector<Panel> panels_;
  std::vector<int> rows_;
  FloatArray values_;
  std::vector<Subtree> subtrees_;
  std::vector<int> taskStart_;    // task t has the subtrees [taskStart_[t], taskStart_[t + 1])
  std::vector<int> top_;          // panels above all subtrees
  std::vector<int> above_;        // rows above each subtree that it changes
  std::size_t solutionRows_ = 0;  // tails included
  std::size_t panelMemory_ = 0;   // floats
};

}  // namespace fascia
