#include <fascia/math/cholesky/multifrontal.h>

#include <atomic>
#include <cmath>

#include <Eigen/Cholesky>

#include <fascia/base/assert.h>
#include <fascia/base/index.h>
#include <fascia/base/parallel.h>

namespace fascia::cholesky {
namespace {

using Matrix = Eigen::MatrixXd;

// A pivot that elimination made smaller than this share of its diagonal entry is rounding.
constexpr double kLeastPivot = 1e-14;

class Multifrontal {
 public:
  Multifrontal(const SparseMatrix& a, const Supernodes& supernodes, const TakeColumns& take)
      : nodes_(supernodes.nodes), take_(take), updates_(nodes_.size()), children_(nodes_.size()) {
    FASCIA_ASSERT(at(static_cast<int>(a.rows())) == supernodes.order.size(),
                  "the supernodes are of this matrix");
    const auto n = static_cast<Eigen::Index>(supernodes.order.size());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> place(n);
    for (Eigen::Index k = 0; k < n; ++k)
      place.indices()[supernodes.order[static_cast<std::size_t>(k)]] = static_cast<int>(k);
    a_.resize(n, n);
    a_.selfadjointView<Eigen::Lower>() = a.selfadjointView<Eigen::Lower>().twistedBy(place);
    for (std::size_t s = 0; s < nodes_.size(); ++s)
      if (nodes_[s].parent >= 0) children_[at(nodes_[s].parent)].push_back(static_cast<int>(s));
  }

  // Working memory of a thread's task.
  struct Memory {
    Matrix front;
    std::vector<int> local;  // row of the front of each row of the matrix
    Eigen::VectorXd diagonal;
  };

  bool eliminate(int s, Memory& memory) {
    const Supernode& node = nodes_[at(s)];
    assemble(s, memory);
    FASCIA_ASSERT(memory.front.rows() >= node.width, "a front holds its own columns");
    Matrix& front = memory.front;
    const Eigen::Index w = node.width, m = front.rows() - w;
    auto triangle = front.topLeftCorner(w, w);
    memory.diagonal = triangle.diagonal();
    if (Eigen::LLT<Eigen::Ref<Matrix>> llt(triangle); llt.info() != Eigen::Success) return false;
    for (Eigen::Index k = 0; k < w; ++k) {
      const double pivot = triangle(k, k);
      // Also false for what is not a number.
      if (!(pivot * pivot > kLeastPivot * memory.diagonal[k]) || !std::isfinite(pivot))
        return false;
    }
    auto below = front.bottomLeftCorner(m, w);
    if (m > 0) {
      triangle.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
      Matrix& update = updates_[at(s)];
      update = front.bottomRightCorner(m, m);
      update.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
    }
    take_(at(s), triangle, below);
    return true;
  }

 private:
  void assemble(int s, Memory& memory) {
    const Supernode& node = nodes_[at(s)];
    const auto size = static_cast<Eigen::Index>(at(node.width) + node.below.size());
    std::vector<int>& local = memory.local;
    local.resize(static_cast<std::size_t>(a_.rows()));
    for (int k = 0; k < node.width; ++k) local[at(node.first + k)] = k;
    for (std::size_t k = 0; k < node.below.size(); ++k)
      local[at(node.below[k])] = node.width + static_cast<int>(k);
    memory.front.setZero(size, size);
    for (int k = 0; k < node.width; ++k)
      for (SparseMatrix::InnerIterator it(a_, node.first + k); it; ++it)
        memory.front(local[at(static_cast<int>(it.row()))], k) = it.value();
    for (const int child : children_[at(s)]) {
      addUpdate(nodes_[at(child)].below, updates_[at(child)], memory);
      updates_[at(child)] = Matrix();
    }
  }

  static void addUpdate(const std::vector<int>& rows, const Matrix& update, Memory& memory) {
    FASCIA_ASSERT(update.rows() == static_cast<Eigen::Index>(rows.size()),
                  "a child left an update of all its rows");
    const auto m = static_cast<Eigen::Index>(rows.size());
    for (Eigen::Index j = 0; j < m; ++j) {
      double* column = &memory.front(0, memory.local[at(rows[static_cast<std::size_t>(j)])]);
      for (Eigen::Index i = j; i < m; ++i)
        column[memory.local[at(rows[static_cast<std::size_t>(i)])]] += update(i, j);
    }
  }

  const std::vector<Supernode>& nodes_;
  const TakeColumns& take_;
  SparseMatrix a_;  // in the order of elimination, lower triangle
  std::vector<Matrix> updates_;
  std::vector<std::vector<int>> children_;
};

}  // namespace

bool factorizeMultifrontal(const SparseMatrix& a, const Supernodes& supernodes, const Tasks& tasks,
                           const TakeColumns& take) {
  Multifrontal multifrontal(a, supernodes, take);
  std::atomic<bool> good = true;
  parallelFor(tasks.count(), [&](std::size_t t) {
    Multifrontal::Memory memory;
    for (int k = tasks.start[t]; k < tasks.start[t + 1]; ++k)
      for (int s = tasks.subtrees[at(k)].first; good && s < tasks.subtrees[at(k)].end; ++s)
        if (!multifrontal.eliminate(s, memory)) good = false;
  });
  Multifrontal::Memory memory;
  for (std::size_t k = 0; good && k < tasks.top.size(); ++k)
    if (!multifrontal.eliminate(tasks.top[k], memory)) good = false;
  return good;
}

}  // namespace fascia::cholesky
