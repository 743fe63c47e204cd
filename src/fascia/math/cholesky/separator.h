#pragma once

#include <cstdint>
#include <vector>

namespace fascia::cholesky {

// A graph whose nodes stand for several of a finer one.
struct WeightedGraph {
  std::vector<int> start{0}, neighbours;  // as in Graph
  std::vector<int> edgeWeight;            // of each neighbour
  std::vector<int> weight;                // of each node

  int size() const { return static_cast<int>(weight.size()); }
};

enum class Side : std::uint8_t { left, right, separator };

// A small set of nodes of a connected graph without which the rest falls into two parts of similar
// weight: found on a coarse version of the graph and refined while that is made finer (multilevel
// bisection, Karypis & Kumar 1998; vertex separators refined as by Ashcraft & Liu 1996). Of each
// node: which part it belongs to. A part may be empty where the graph is nearly complete.
std::vector<Side> findSeparator(const WeightedGraph& graph);

}  // namespace fascia::cholesky
