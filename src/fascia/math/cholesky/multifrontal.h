#pragma once

#include <functional>

#include <Eigen/Core>

#include <fascia/math/cholesky/subtrees.h>

namespace fascia::cholesky {

// Takes the finished columns of supernode `s`: the lower triangle T of its own rows, and the rows
// below. Called once for each, by several threads.
using TakeColumns =
    std::function<void(std::size_t s, const Eigen::Ref<const Eigen::MatrixXd>& triangle,
                       const Eigen::Ref<const Eigen::MatrixXd>& below)>;

// A = L Lᵀ with one dense front per supernode (Duff & Reid 1983; Liu 1992, "The multifrontal method
// for sparse matrix solution"). False if A is not finite, or not positive definite by so much that
// rounding would not decide about it.
[[nodiscard]] bool factorizeMultifrontal(const SparseMatrix& a, const Supernodes& supernodes,
                                         const Tasks& tasks, const TakeColumns& take);

}  // namespace fascia::cholesky
