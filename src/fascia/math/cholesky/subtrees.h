#pragma once

#include <vector>

#include <fascia/math/cholesky/supernodes.h>

namespace fascia::cholesky {

// The supernodes [first, end) of a subtree; its root is the last.
struct Subtree {
  int first = 0, end = 0;
};

// Who works on what: tasks do not touch each other's columns.
struct Tasks {
  std::vector<Subtree> subtrees;  // in the order of elimination
  std::vector<int> start{0};      // task t has the subtrees [start[t], start[t + 1])
  std::vector<int> top;           // supernodes above all subtrees, in the order of elimination
  std::size_t count() const { return start.size() - 1; }
};

// Depends on the supernodes only, not on the number of threads: so results do not either.
Tasks splitIntoTasks(const Supernodes& supernodes);

}  // namespace fascia::cholesky
