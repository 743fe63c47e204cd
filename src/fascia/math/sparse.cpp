#include <fascia/math/sparse.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

bool allFinite(const SparseMatrix& a) {
  return std::all_of(a.valuePtr(), a.valuePtr() + a.nonZeros(),
                     [](double x) { return std::isfinite(x); });
}

}  // namespace

struct SparseFactorization::Impl {
  // The places of a compressed matrix's entries, to tell whether the ordering can be kept.
  class Pattern {
   public:
    bool matches(const SparseMatrix& a) const {
      return rows_ == a.rows() && std::ranges::equal(outer_, outer(a)) &&
             std::ranges::equal(inner_, inner(a));
    }
    void assign(const SparseMatrix& a) {
      rows_ = a.rows();
      outer_.assign(outer(a).begin(), outer(a).end());
      inner_.assign(inner(a).begin(), inner(a).end());
    }

   private:
    using Indices = std::span<const SparseMatrix::StorageIndex>;
    static Indices outer(const SparseMatrix& a) {
      return {a.outerIndexPtr(), static_cast<std::size_t>(a.outerSize()) + 1};
    }
    static Indices inner(const SparseMatrix& a) {
      return {a.innerIndexPtr(), static_cast<std::size_t>(a.nonZeros())};
    }
    Eigen::Index rows_ = -1;
    std::vector<SparseMatrix::StorageIndex> outer_, inner_;
  };

  enum class Ready { none, cholesky, lu };
  MatrixKind kind;
  Ready ready = Ready::none;
  int symbolicCount = 0;
  Pattern choleskyPattern, luPattern;
  Eigen::SimplicialLDLT<SparseMatrix> cholesky;
  Eigen::SparseLU<SparseMatrix> lu;

  bool factorizeSymmetric(const SparseMatrix& a) {
    FASCIA_ASSERT(a.isCompressed() && a.rows() == a.cols(), "the matrix is square and compressed");
    if (!choleskyPattern.matches(a)) {
      cholesky.analyzePattern(a);
      choleskyPattern.assign(a);
      ++symbolicCount;
    }
    cholesky.factorize(a);
    return cholesky.info() == Eigen::Success;
  }

  bool factorizeGeneral(const SparseMatrix& a) {
    FASCIA_ASSERT(a.isCompressed() && a.rows() == a.cols(), "the matrix is square and compressed");
    if (!luPattern.matches(a)) {
      lu.analyzePattern(a);
      luPattern.assign(a);
      ++symbolicCount;
    }
    lu.factorize(a);
    return lu.info() == Eigen::Success;
  }
};

SparseFactorization::SparseFactorization(MatrixKind kind) : impl_(std::make_unique<Impl>()) {
  impl_->kind = kind;
}
SparseFactorization::~SparseFactorization() = default;
SparseFactorization::SparseFactorization(SparseFactorization&&) noexcept = default;
SparseFactorization& SparseFactorization::operator=(SparseFactorization&&) noexcept = default;

bool SparseFactorization::factorize(const SparseMatrix& a) {
  Impl& self = *impl_;
  self.ready = Impl::Ready::none;
  if (a.rows() != a.cols()) return false;
  if (!a.isCompressed()) {
    SparseMatrix compressed = a;
    compressed.makeCompressed();
    return factorize(compressed);
  }
  if (!allFinite(a)) return false;
  if (self.kind == MatrixKind::symmetric && self.factorizeSymmetric(a)) {
    self.ready = Impl::Ready::cholesky;
  } else if (self.factorizeGeneral(a)) {
    self.ready = Impl::Ready::lu;
  }
  return self.ready != Impl::Ready::none;
}

bool SparseFactorization::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) const {
  const Impl& self = *impl_;
  if (self.ready == Impl::Ready::none) return false;
  Eigen::VectorXd solution;
  if (self.ready == Impl::Ready::cholesky) {
    if (b.size() != self.cholesky.rows()) return false;
    solution = self.cholesky.solve(b);
  } else {
    if (b.size() != self.lu.rows()) return false;
    solution = self.lu.solve(b);
  }
  if (!solution.allFinite()) return false;
  x.swap(solution);
  return true;
}

int SparseFactorization::symbolicCount() const {
  return impl_->symbolicCount;
}

bool solveSparse(const SparseMatrix& a, const Eigen::VectorXd& b, Eigen::VectorXd& x,
                 MatrixKind kind) {
  SparseFactorization factorization(kind);
  return factorization.factorize(a) && factorization.solve(b, x);
}

}  // namespace fascia
