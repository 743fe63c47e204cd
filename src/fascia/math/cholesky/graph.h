#pragma once

#include <span>
#include <vector>

#include <fascia/math/sparse.h>

namespace fascia::cholesky {

// Which rows of a symmetric matrix share an entry, in both directions, without the diagonal.
struct Graph {
  std::vector<int> start{0};    // one more than there are nodes
  std::vector<int> neighbours;  // of node i: [start[i], start[i + 1])

  int size() const { return static_cast<int>(start.size()) - 1; }
  std::span<const int> of(int node) const {
    const auto first = static_cast<std::size_t>(start[static_cast<std::size_t>(node)]);
    const auto last = static_cast<std::size_t>(start[static_cast<std::size_t>(node) + 1]);
    return {neighbours.data() + first, last - first};
  }
};

// Reads the lower triangle.
Graph graphOf(const SparseMatrix& a);

}  // namespace fascia::cholesky
