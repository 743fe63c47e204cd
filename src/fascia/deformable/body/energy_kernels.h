#pragma once

#include <cstddef>
#include <vector>

#include <fascia/base/aligned.h>

namespace fascia {

// SIMD kernels for the sums over a body's energy points, dispatched at run time: worth it for
// bodies of many functions. Tensors ∂x/∂X have dimension² numbers, the one of coordinate `row` and
// axis `axis` at number a = axis dimension + row; those of all points lie in rows of pointStride.

using DoubleArray = std::vector<double, AlignedAllocator<double>>;

// ∂s/∂X of a body's functions at its energy points, once for sums by point and once for sums by
// function. What pads rows is 0.
struct SlopeTable {
  static constexpr std::size_t kPointGroup = 8, kFunctionGroup = 8, kTensorGroup = 8;
  // Numbers of a tensor of third order, padded.
  static constexpr std::size_t tensorStride(std::size_t dimension) {
    return (dimension * dimension * dimension + kTensorGroup - 1) / kTensorGroup * kTensorGroup;
  }

  int functions = 0, dimension = 0;
  std::size_t points = 0, pointStride = 0, functionStride = 0;
  DoubleArray byPoint;     // functions x dimension rows of pointStride
  DoubleArray byFunction;  // points x dimension rows of functionStride

  SlopeTable() = default;
  // slopes: points x functions x dimension.
  SlopeTable(int functions, int dimension, const std::vector<double>& slopes);
  std::size_t tensorSize() const {  // of one number for each pair of coordinate and axis
    return static_cast<std::size_t>(dimension * dimension) * pointStride;
  }
};

// F = Σ_j q_j ⊗ ∂s_j/∂X, tensorSize() numbers. q: functions x dimension.
void sumGradients(const SlopeTable& table, const double* q, double* F);
// f_j += Σ P ∂s_j/∂X over all points, of tensors P. f: functions x dimension.
void addStressForces(const SlopeTable& table, const double* P, double* f);
// H += Σ Bᵀ K B with B = ∂F/∂q, of symmetric K = ∂P/∂F: for each point and axis β tensorStride
// numbers, ∂P(r, α)/∂F(s, β) at number (α dimension + r) dimension + s, 0 in the padding. H:
// (functions x dimension) squared, columns hStride apart; `scratch` is resized as needed.
void addCongruences(const SlopeTable& table, const double* K, double* H, std::size_t hStride,
                    DoubleArray& scratch);

}  // namespace fascia
