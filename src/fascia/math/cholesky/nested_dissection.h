#pragma once

#include <vector>

#include <fascia/math/cholesky/graph.h>

namespace fascia::cholesky {

// An order of elimination that gives little fill and independent subtrees: a small separator splits
// the graph into two parts, which are ordered the same way, and comes last (George 1973, "Nested
// dissection of a regular finite element mesh"). result[k]: the node that is eliminated as number
// k.
std::vector<int> nestedDissection(const Graph& graph);

}  // namespace fascia::cholesky
