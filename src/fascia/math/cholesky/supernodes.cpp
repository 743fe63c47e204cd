#include <fascia/math/cholesky/supernodes.h>

#include <algorithm>
#include <numeric>

#include <fascia/base/assert.h>
#include <fascia/base/index.h>

namespace fascia::cholesky {
namespace {

std::vector<int> inverse(const std::vector<int>& order) {
  FASCIA_ASSERT(areBelow(order, order.size()), "an order numbers its own entries");
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[at(order[k])] = static_cast<int>(k);
  return place;
}

// Parents of a forest → an order with children before parents and subtrees without gaps.
std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> firstChild(at(n), -1), sibling(at(n), -1), order, stack;
  for (int i = n - 1; i >= 0; --i) {
    if (parent[at(i)] < 0) continue;
    sibling[at(i)] = firstChild[at(parent[at(i)])];
    firstChild[at(parent[at(i)])] = i;
  }
  order.reserve(at(n));
  for (int root = 0; root < n; ++root) {
    if (parent[at(root)] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int node = stack.back(), child = firstChild[at(node)];
      if (child >= 0) {
        firstChild[at(node)] = sibling[at(child)];
        stack.push_back(child);
      } else {
        order.push_back(node);
        stack.pop_back();
      }
    }
  }
  return order;
}

// Parent of each column in the elimination tree (Liu 1986), columns numbered by elimination.
std::vector<int> eliminationTree(const Graph& graph, const std::vector<int>& order) {
  FASCIA_ASSERT(order.size() == at(graph.size()), "every node has a place");
  const std::vector<int> place = inverse(order);
  const std::size_t n = order.size();
  std::vector<int> parent(n, -1), ancestor(n, -1);
  for (std::size_t k = 0; k < n; ++k) {
    for (const int neighbour : graph.of(order[k])) {
      int i = place[at(neighbour)];
      while (i >= 0 && i < static_cast<int>(k)) {
        const int up = ancestor[at(i)];
        ancestor[at(i)] = static_cast<int>(k);
        if (up < 0) parent[at(i)] = static_cast<int>(k);
        i = up;
      }
    }
  }
  return parent;
}

// Entries of each column of the factor, the diagonal included.
std::vector<int> columnCounts(const Graph& graph, const std::vector<int>& order,
                              const std::vector<int>& parent) {
  FASCIA_ASSERT(parent.size() == order.size(), "every column has a parent or none");
  const std::vector<int> place = inverse(order);
  const int n = static_cast<int>(order.size());
  std::vector<int> count(at(n), 1), mark(at(n), -1);
  for (int row = 0; row < n; ++row) {
    mark[at(row)] = row;
    for (const int neighbour : graph.of(order[at(row)]))
      for (int i = place[at(neighbour)]; i < row && mark[at(i)] != row; i = parent[at(i)]) {
        ++count[at(i)];
        mark[at(i)] = row;
      }
  }
  return count;
}

// Supernodes while they are merged: column lists, and how many rows are below.
struct Draft {
  std::vector<std::vector<int>> columns;
  std::vector<int> below, parent;  // parent -1 = root, -2 = merged away
};

Draft fundamentalSupernodes(const std::vector<int>& parent, const std::vector<int>& count) {
  FASCIA_ASSERT(parent.size() == count.size(), "every column is counted");
  Draft draft;
  std::vector<int> owner(parent.size());
  for (std::size_t j = 0; j < parent.size(); ++j) {
    const bool goesOn =
        j > 0 && parent[j - 1] == static_cast<int>(j) && count[j - 1] == count[j] + 1;
    if (!goesOn) draft.columns.emplace_back();
    draft.columns.back().push_back(static_cast<int>(j));
    owner[j] = static_cast<int>(draft.columns.size()) - 1;
  }
  for (const std::vector<int>& columns : draft.columns) {
    const std::size_t last = at(columns.back());
    draft.below.push_back(count[last] - 1);
    draft.parent.push_back(parent[last] < 0 ? -1 : owner[at(parent[last])]);
  }
  return draft;
}

// What a solve pays for a supernode, in stored floats' worth of time. Measured: a row costs more
// than an entry because it is gathered and scattered; larger constants make fewer, wider
// supernodes.
double solveCost(double width, double below) {
  constexpr double kPerRow = 5, kPerSupernode = 60;
  return width * (0.5 * width + below) + kPerRow * (width + below) + kPerSupernode;
}

void mergeChildren(int node, std::vector<int>& children, Draft& draft) {
  FASCIA_ASSERT(draft.parent[at(node)] != -2, "only what is left takes in others");
  // Those with the most rows in common first: a merged parent is wider, and its next child gains
  // less.
  std::stable_sort(children.begin(), children.end(),
                   [&](int a, int b) { return draft.below[at(a)] > draft.below[at(b)]; });
  const double below = draft.below[at(node)];
  std::vector<int>& columns = draft.columns[at(node)];
  auto width = static_cast<double>(columns.size());
  std::vector<int> merged;
  for (const int child : children) {
    const auto childWidth = static_cast<double>(draft.columns[at(child)].size());
    const double apart = solveCost(width, below) + solveCost(childWidth, draft.below[at(child)]);
    if (solveCost(width + childWidth, below) > apart) continue;
    merged.insert(merged.end(), draft.columns[at(child)].begin(), draft.columns[at(child)].end());
    width += childWidth;
    draft.parent[at(child)] = -2;
    draft.columns[at(child)].clear();
  }
  if (!merged.empty()) columns.insert(columns.begin(), merged.begin(), merged.end());
}

void mergeSmall(Draft& draft) {
  const int n = static_cast<int>(draft.parent.size());
  std::vector<std::vector<int>> children(at(n));
  for (int s = 0; s < n; ++s) {
    const std::vector<int> mine = children[at(s)];
    mergeChildren(s, children[at(s)], draft);
    std::vector<int> left;
    for (const int child : mine) {
      if (draft.parent[at(child)] != -2) {
        left.push_back(child);
        continue;
      }
      for (const int grandchild : children[at(child)]) {
        draft.parent[at(grandchild)] = s;
        left.push_back(grandchild);
      }
      children[at(child)].clear();
    }
    children[at(s)] = std::move(left);
    if (draft.parent[at(s)] >= 0) children[at(draft.parent[at(s)])].push_back(s);
  }
}

// Numbers supernodes and their columns anew, subtree by subtree.
Supernodes numbered(const Draft& draft, const std::vector<int>& order) {
  const std::size_t n = draft.parent.size();
  std::vector<int> kept, number(n, -1);
  for (std::size_t s = 0; s < n; ++s)
    if (draft.parent[s] != -2) {
      number[s] = static_cast<int>(kept.size());
      kept.push_back(static_cast<int>(s));
    }
  std::vector<int> parent;
  parent.reserve(kept.size());
  for (const int s : kept)
    parent.push_back(draft.parent[at(s)] < 0 ? -1 : number[at(draft.parent[at(s)])]);
  const std::vector<int> post = postorder(parent), place = inverse(post);
  Supernodes result;
  for (const int k : post) {
    const std::vector<int>& columns = draft.columns[at(kept[at(k)])];
    Supernode& node = result.nodes.emplace_back();
    node.first = static_cast<int>(result.order.size());
    node.width = static_cast<int>(columns.size());
    node.parent = parent[at(k)] < 0 ? -1 : place[at(parent[at(k)])];
    for (const int column : columns) result.order.push_back(order[at(column)]);
  }
  return result;
}

void findRowsBelow(const Graph& graph, Supernodes& supernodes) {
  const std::vector<int> place = inverse(supernodes.order);
  std::vector<int> mark(supernodes.order.size(), -1);
  std::vector<std::vector<int>> children(supernodes.nodes.size());
  for (std::size_t s = 0; s < supernodes.nodes.size(); ++s) {
    Supernode& node = supernodes.nodes[s];
    const int end = node.first + node.width;
    const auto add = [&](int row) {
      if (row < end || mark[at(row)] == static_cast<int>(s)) return;
      mark[at(row)] = static_cast<int>(s);
      node.below.push_back(row);
    };
    for (int column = node.first; column < end; ++column)
      for (const int neighbour : graph.of(supernodes.order[at(column)])) add(place[at(neighbour)]);
    for (const int child : children[s])
      for (const int row : supernodes.nodes[at(child)].below) add(row);
    std::sort(node.below.begin(), node.below.end());
    if (node.parent >= 0) children[at(node.parent)].push_back(static_cast<int>(s));
  }
}

}  // namespace

Supernodes findSupernodes(const Graph& graph, const std::vector<int>& wanted) {
  FASCIA_ASSERT(wanted.size() == at(graph.size()), "every node is ordered");
  std::vector<int> order(wanted.size());
  const std::vector<int> post = postorder(eliminationTree(graph, wanted));
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = wanted[at(post[k])];
  const std::vector<int> parent = eliminationTree(graph, order);
  Draft draft = fundamentalSupernodes(parent, columnCounts(graph, order, parent));
  mergeSmall(draft);
  Supernodes result = numbered(draft, order);
  FASCIA_ASSERT(result.order.size() == order.size(), "merging loses no column");
  findRowsBelow(graph, result);
  return result;
}

}  // namespace fascia::cholesky
