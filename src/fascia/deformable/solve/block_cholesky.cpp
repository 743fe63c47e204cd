#include <fascia/deformable/solve/block_cholesky.h>

#include <algorithm>
#include <iterator>
#include <set>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Nodes that hang together, sorted.
using Graph = std::vector<std::vector<int>>;

Graph graphOf(std::size_t count, std::span<const std::pair<int, int>> edges) {
  Graph graph(count);
  for (const auto& [i, j] : edges) graph[i].push_back(j), graph[j].push_back(i);
  FASCIA_ASSERT(std::ranges::all_of(
                    graph, [&](const auto& neighbours) { return areBelow(neighbours, count); }),
                "neighbours are nodes");
  for (std::vector<int>& neighbours : graph) {
    std::ranges::sort(neighbours);
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  }
  return graph;
}

// Minimum degree (Tinney & Walker 1967): eliminates the node with the fewest neighbours left, which
// hang together from then on. Leaves the nodes that hung on each when it went: the rows of its
// column of L. Trees lose leaf after leaf, without fill.
std::vector<int> eliminateByDegree(Graph& graph) {
  std::set<std::pair<std::size_t, int>> left;
  for (std::size_t i = 0; i < graph.size(); ++i) left.emplace(graph[i].size(), static_cast<int>(i));
  std::vector<int> order, merged;
  while (!left.empty()) {
    const int node = left.begin()->second;
    left.erase(left.begin());
    order.push_back(node);
    for (const int other : graph[node]) {
      std::vector<int>& neighbours = graph[other];
      left.erase({neighbours.size(), other});
      merged.clear();
      std::ranges::set_union(neighbours, graph[node], std::back_inserter(merged));
      std::erase_if(merged, [&](int n) { return n == node || n == other; });
      neighbours.assign(merged.begin(), merged.end());
      left.emplace(neighbours.size(), other);
    }
  }
  return order;
}

}  // namespace

void BlockCholesky::setPattern(std::size_t count,
                               std::span<const std::pair<int, int>> offDiagonal) {
  Graph graph = graphOf(count, offDiagonal);
  order_ = eliminateByDegree(graph);
  place_.resize(count);
  for (std::size_t i = 0; i < count; ++i) place_[order_[i]] = static_cast<int>(i);
  columnFirst_.assign(1, 0);
  rows_.clear();
  for (std::size_t j = 0; j < count; ++j) {
    for (const int node : graph[order_[j]]) rows_.push_back(place_[node]);
    std::sort(rows_.begin() + static_cast<std::ptrdiff_t>(columnFirst_[j]), rows_.end());
    columnFirst_.push_back(rows_.size());
  }
  blocks_.resize(rows_.size());
  diagonal_.resize(count), diagonalEntries_.resize(count), pivots_.resize(count);
  dropped_.assign(count, 0), work_.resize(count);
  setZero();
}

void BlockCholesky::setZero() {
  std::ranges::fill(blocks_, Mat3::Zero());
  std::ranges::fill(diagonal_, Mat3::Zero());
}

std::size_t BlockCholesky::slot(int row, int column) const {
  const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(columnFirst_[column]);
  const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(columnFirst_[column + 1]);
  return static_cast<std::size_t>(std::lower_bound(begin, end, row) - rows_.begin());
}

void BlockCholesky::add(int i, int j, const Mat3& value) {
  const int row = place_[i], column = place_[j];
  if (row == column) {
    diagonal_[row] += value;
  } else if (row > column) {
    blocks_[slot(row, column)] += value;
  } else {
    blocks_[slot(column, row)] += value.transpose();
  }
}

void BlockCholesky::factorizeAndFindDependent(double tolerance) {
  std::ranges::fill(dropped_, static_cast<unsigned char>(0));
  eliminate(true, tolerance);
}

bool BlockCholesky::factorize() {
  return eliminate(false, 0);
}

bool BlockCholesky::eliminate(bool find, double tolerance) {
  for (std::size_t j = 0; j < order_.size(); ++j) diagonalEntries_[j] = diagonal_[j].diagonal();
  bool positive = true;
  for (std::size_t j = 0; j < order_.size(); ++j) {
    unsigned char& dropped = dropped_[order_[j]];
    for (int row = 0; find && row < 3; ++row) {
      // The pivot of a row, given those before it in its block.
      const Pivot pivot = pivotOf(diagonal_[j], dropped);
      const double d = pivot.inverse[row] > 0 ? 1 / pivot.inverse[row] : 0;
      if (!(d > tolerance * diagonalEntries_[j][row]))
        dropped = static_cast<unsigned char>(dropped | (1u << row));
    }
    pivots_[j] = pivotOf(diagonal_[j], dropped);
    for (int row = 0; row < 3; ++row)
      positive &= (dropped >> row & 1) != 0 || pivots_[j].inverse[row] > 0;
    updateBelow(j);
  }
  return positive;
}

BlockCholesky::Pivot BlockCholesky::pivotOf(const Mat3& A, unsigned char dropped) {
  Pivot pivot{Mat3::Identity(), Vec3::Zero(), Mat3::Zero()};
  Mat3& L = pivot.lower;
  Vec3 d = Vec3::Zero();
  for (int j = 0; j < 3; ++j) {
    d[j] = A(j, j);
    for (int m = 0; m < j; ++m) d[j] -= L(j, m) * L(j, m) * d[m];
    if ((dropped >> j & 1) != 0 || !(d[j] > 0)) d[j] = 0;
    pivot.inverse[j] = d[j] > 0 ? 1 / d[j] : 0;
    for (int i = j + 1; i < 3; ++i) {
      double sum = A(i, j);
      for (int m = 0; m < j; ++m) sum -= L(i, m) * L(j, m) * d[m];
      L(i, j) = sum * pivot.inverse[j];
    }
  }
  // The unit triangle's inverse in closed form.
  Mat3 inverse = Mat3::Identity();
  inverse(1, 0) = -L(1, 0);
  inverse(2, 1) = -L(2, 1);
  inverse(2, 0) = L(1, 0) * L(2, 1) - L(2, 0);
  pivot.inverseOfBlock = inverse.transpose() * pivot.inverse.asDiagonal() * inverse;
  return pivot;
}

// Turns a column of A into one of L, and takes its outer product from the columns after it.
void BlockCholesky::updateBelow(std::size_t column) {
  FASCIA_ASSERT(column + 1 < columnFirst_.size(), "the column exists");
  const std::size_t first = columnFirst_[column], last = columnFirst_[column + 1];
  for (std::size_t b = first; b < last; ++b) {
    const int target = rows_[b];
    const Mat3 scaled = blocks_[b] * pivots_[column].inverseOfBlock;
    diagonal_[target].noalias() -= scaled * blocks_[b].transpose();
    // Later rows of this column are rows of the target column too, in the same order.
    std::size_t at = columnFirst_[target];
    for (std::size_t a = b + 1; a < last; ++a) {
      while (rows_[at] != rows_[a]) ++at;
      blocks_[at].noalias() -= blocks_[a] * scaled.transpose();
    }
  }
  for (std::size_t b = first; b < last; ++b)
    blocks_[b] = (blocks_[b] * pivots_[column].inverseOfBlock).eval();
}

void BlockCholesky::solve(std::span<Vec3> x) const {
  FASCIA_ASSERT(x.size() == order_.size() && pivots_.size() == order_.size(),
                "a block for each constraint");
  const std::size_t n = order_.size();
  for (std::size_t j = 0; j < n; ++j) work_[j] = x[order_[j]];
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t b = columnFirst_[j]; b < columnFirst_[j + 1]; ++b)
      work_[rows_[b]].noalias() -= blocks_[b] * work_[j];
  for (std::size_t j = n; j-- > 0;) {
    Vec3 sum = pivots_[j].inverseOfBlock * work_[j];
    for (std::size_t b = columnFirst_[j]; b < columnFirst_[j + 1]; ++b)
      sum.noalias() -= blocks_[b].transpose() * work_[rows_[b]];
    work_[j] = sum;
  }
  for (std::size_t j = 0; j < n; ++j) x[order_[j]] = work_[j];
}

void BlockCholesky::dependence(int block, int row, std::span<Vec3> n) const {
  FASCIA_ASSERT(static_cast<std::size_t>(block) < place_.size() && row >= 0 && row < 3 &&
                    n.size() == order_.size(),
                "the row exists");
  // A n = 0 restricted to the rows kept: A_KK n_K = −A_Kr. With the full unit L of the scalar
  // factorisation this is the row's column of L⁻ᵀ: a back-substitution, blocks and their triangles.
  const std::size_t count = order_.size(), start = static_cast<std::size_t>(place_[block]);
  std::ranges::fill(work_, Vec3::Zero());
  const auto throughTriangle = [&](std::size_t j, Vec3 y) {  // lower⁻ᵀ y
    const Mat3& L = pivots_[j].lower;
    y[1] -= L(2, 1) * y[2];
    y[0] -= L(1, 0) * y[1] + L(2, 0) * y[2];
    return y;
  };
  work_[start] = throughTriangle(start, Vec3::Unit(row));
  for (std::size_t j = start; j-- > 0;) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = columnFirst_[j]; b < columnFirst_[j + 1]; ++b)
      sum.noalias() -= blocks_[b].transpose() * work_[rows_[b]];
    work_[j] = sum;
  }
  for (std::size_t j = 0; j < count; ++j) n[order_[j]] = work_[j];
}

}  // namespace fascia
