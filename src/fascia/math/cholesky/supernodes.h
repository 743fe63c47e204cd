#pragma once

#include <vector>

#include <fascia/math/cholesky/graph.h>

namespace fascia::cholesky {

// Neighbouring columns of the factor that are stored as one dense panel: a triangle of `width`
// columns, and the same rows below for all of them.
struct Supernode {
  int first = 0, width = 0;  // columns, in the order of elimination
  int parent = -1;           // the supernode of the first row below; -1 = a root
  std::vector<int> below;    // rows below the triangle, ascending
};

struct Supernodes {
  std::vector<int> order;        // order[k]: which row of the matrix is eliminated as number k
  std::vector<Supernode> nodes;  // children before parents, each subtree without gaps
};

// Finds the supernodes of the factor of a matrix whose rows are eliminated in the given order. The
// order may change inside of what gives the same fill. Small supernodes are merged where the zeros
// that this stores cost a solve less than the overhead that it saves (relaxed supernodes, Ashcraft
// & Grimes 1989, "The influence of relaxed supernode partitions on the multifrontal method").
Supernodes findSupernodes(const Graph& graph, const std::vector<int>& order);

}  // namespace fascia::cholesky
