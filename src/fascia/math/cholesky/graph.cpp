#include <fascia/math/cholesky/graph.h>

#include <fascia/base/assert.h>

namespace fascia::cholesky {

Graph graphOf(const SparseMatrix& a) {
  FASCIA_ASSERT(a.rows() == a.cols(), "the matrix is square");
  const auto n = static_cast<std::size_t>(a.rows());
  const auto forEachEdge = [&a](const auto& use) {
    for (int column = 0; column < a.cols(); ++column)
      for (SparseMatrix::InnerIterator it(a, column); it; ++it)
        if (it.row() > column) use(static_cast<std::size_t>(it.row()), column);
  };
  Graph graph;
  graph.start.assign(n + 1, 0);
  forEachEdge([&](std::size_t row, int column) {
    ++graph.start[row + 1];
    ++graph.start[static_cast<std::size_t>(column) + 1];
  });
  for (std::size_t i = 0; i < n; ++i) graph.start[i + 1] += graph.start[i];
  graph.neighbours.resize(static_cast<std::size_t>(graph.start[n]));
  std::vector<int> next(graph.start.begin(), graph.start.end() - 1);
  forEachEdge([&](std::size_t row, int column) {
    const auto c = static_cast<std::size_t>(column);
    graph.neighbours[static_cast<std::size_t>(next[row]++)] = column;
    graph.neighbours[static_cast<std::size_t>(next[c]++)] = static_cast<int>(row);
  });
  FASCIA_ASSERT(areBelow(graph.neighbours, n), "neighbours are nodes");
  return graph;
}

}  // namespace fascia::cholesky
