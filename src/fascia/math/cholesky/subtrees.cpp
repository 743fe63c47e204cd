#include <fascia/math/cholesky/subtrees.h>

#include <algorithm>

#include <fascia/base/assert.h>
#include <fascia/base/index.h>

namespace fascia::cholesky {
namespace {

// More tasks spread better, but leave more above them that is done by one thread.
constexpr double kShare = 1.0 / 12;
// Fewer entries of the factor than this are not worth a task: about 10 microseconds.
constexpr double kSmallest = 20e3;

double entries(const Supernode& node) {
  return node.width * (0.5 * node.width + static_cast<double>(node.below.size()));
}

}  // namespace

Tasks splitIntoTasks(const Supernodes& supernodes) {
  const std::vector<Supernode>& nodes = supernodes.nodes;
  const int n = static_cast<int>(nodes.size());
  std::vector<double> work(at(n), 0);
  std::vector<int> first(at(n));
  for (int s = 0; s < n; ++s) first[at(s)] = s;
  double all = 0;
  for (int s = 0; s < n; ++s) {
    const double own = entries(nodes[at(s)]);
    all += own;
    work[at(s)] += own;
    const int parent = nodes[at(s)].parent;
    if (parent < 0) continue;
    work[at(parent)] += work[at(s)];
    FASCIA_ASSERT(parent > s, "parents come after their children");
    first[at(parent)] = std::min(first[at(parent)], first[at(s)]);
  }
  const double most = std::max(kSmallest, kShare * all);
  // Work of a subtree is never more than its parent's: what is small enough forms whole subtrees.
  const auto isTop = [&](int s) { return work[at(s)] > most; };
  Tasks tasks;
  double inTask = 0;
  for (int s = 0; s < n; ++s) {
    if (isTop(s)) {
      tasks.top.push_back(s);
      continue;
    }
    const int parent = nodes[at(s)].parent;
    if (parent >= 0 && !isTop(parent)) continue;
    if (inTask > 0 && inTask + work[at(s)] > most) {
      tasks.start.push_back(static_cast<int>(tasks.subtrees.size()));
      inTask = 0;
    }
    tasks.subtrees.push_back({first[at(s)], s + 1});
    inTask += work[at(s)];
  }
  if (inTask > 0) tasks.start.push_back(static_cast<int>(tasks.subtrees.size()));
  return tasks;
}

}  // namespace fascia::cholesky
