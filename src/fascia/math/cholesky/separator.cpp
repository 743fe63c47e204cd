#include <fascia/math/cholesky/separator.h>

#include <algorithm>
#include <numeric>
#include <queue>

#include <fascia/base/assert.h>
#include <fascia/base/index.h>
#include <fascia/base/random.h>

namespace fascia::cholesky {
namespace {

constexpr int kCoarsest = 100;
constexpr int kTries = 4;
constexpr int kPasses = 3;
constexpr int kPatience = 40;
constexpr double kLargestPart = 0.6;  // of the weight

template <class Use>
void forNeighbours(const WeightedGraph& graph, int node, Use&& use) {
  for (int e = graph.start[at(node)]; e < graph.start[at(node) + 1]; ++e)
    use(graph.neighbours[at(e)], graph.edgeWeight[at(e)]);
}

// Improves a separator by moving its nodes to a side, which pulls neighbours on the other side into
// it: always the best move that is left, also if it makes things worse for a while; in the end the
// best state on the way is taken (Fiduccia & Mattheyses 1982).
class Refinement {
 public:
  Refinement(const WeightedGraph& graph, std::vector<Side>& side)
      : graph_(graph),
        side_(side),
        beside_{std::vector<int>(side.size()), std::vector<int>(side.size())},
        lockedIn_(side.size(), 0),
        offeredIn_(side.size(), 0) {
    for (int v = 0; v < graph.size(); ++v) {
      total_[index(side[at(v)])] += graph.weight[at(v)];
      if (side[at(v)] == Side::separator) continue;
      forNeighbours(graph, v, [&](int u, int) {
        beside_[index(side_[at(v)])][at(u)] += graph_.weight[at(v)];
      });
    }
    largest_ = static_cast<int>(kLargestPart * (total_[0] + total_[1] + total_[2]));
  }

  void run() {
    for (int pass = 1; pass <= kPasses; ++pass)
      if (!improve(pass)) break;
  }

  // The less the better; parts that are too large count much.
  std::int64_t score() const {
    const std::int64_t more = std::max(total_[0], total_[1]);
    const std::int64_t excess = std::max<std::int64_t>(0, more - largest_);
    // Between equal separators, balance decides.
    const std::int64_t all = total_[0] + total_[1] + total_[2];
    return (total_[2] + 4 * excess) * 4 * all + std::abs(total_[0] - total_[1]);
  }

 private:
  static std::size_t index(Side side) { return static_cast<std::size_t>(side); }

  struct Move {
    int gain, node;
    Side to;
    bool operator<(const Move& b) const {
      return gain != b.gain ? gain < b.gain : node != b.node ? node < b.node : to < b.to;
    }
  };

  int gain(int v, Side to) const { return graph_.weight[at(v)] - beside_[1 - index(to)][at(v)]; }

  void offer(int v, Side to, int pass) {
    if (side_[at(v)] == Side::separator && lockedIn_[at(v)] != pass)
      queue_[index(to)].push({gain(v, to), v, to});
  }

  void put(int v, Side to) {
    const Side from = side_[at(v)];
    const int weight = graph_.weight[at(v)];
    changes_.push_back({v, from});
    side_[at(v)] = to;
    total_[index(from)] -= weight;
    total_[index(to)] += weight;
    forNeighbours(graph_, v, [&](int u, int) {
      if (from != Side::separator) beside_[index(from)][at(u)] -= weight;
      if (to != Side::separator) beside_[index(to)][at(u)] += weight;
    });
  }

  bool top(Side to, int pass, Move& move) {
    auto& queue = queue_[index(to)];
    while (!queue.empty()) {
      move = queue.top();
      const bool current = side_[at(move.node)] == Side::separator &&
                           lockedIn_[at(move.node)] != pass && move.gain == gain(move.node, to);
      if (current) return true;
      queue.pop();
    }
    return false;
  }

  bool next(int pass, Move& best) {
    bool found = false;
    for (const Side to : {Side::left, Side::right}) {
      Move move{};
      if (!top(to, pass, move)) continue;
      const std::size_t t = index(to);
      const bool fits =
          total_[t] + graph_.weight[at(move.node)] <= largest_ || total_[t] < total_[1 - t];
      if (!fits) continue;
      const bool better =
          !found || move.gain > best.gain || (move.gain == best.gain && total_[t] < total_[1 - t]);
      if (better) best = move;
      found = true;
    }
    return found;
  }

  void make(const Move& move, int pass) {
    const Side other = move.to == Side::left ? Side::right : Side::left;
    queue_[index(move.to)].pop();
    lockedIn_[at(move.node)] = pass;
    put(move.node, move.to);
    pulled_.clear();
    forNeighbours(graph_, move.node, [&](int u, int) {
      if (side_[at(u)] == other) pulled_.push_back(u);
    });
    for (const int u : pulled_) put(u, Side::separator);
    // Whose gain is another one now, each of them once.
    forNeighbours(graph_, move.node, [&](int u, int) { offer(u, other, pass); });
    ++round_;
    for (const int p : pulled_)
      forNeighbours(graph_, p, [&](int u, int) {
        if (offeredIn_[at(u)] == round_) return;
        offeredIn_[at(u)] = round_;
        offer(u, move.to, pass);
      });
    for (const int p : pulled_)
      if (offeredIn_[at(p)] != round_) offer(p, move.to, pass);
  }

  bool improve(int pass) {
    for (auto& queue : queue_) queue = {};
    changes_.clear();
    for (int v = 0; v < graph_.size(); ++v)
      for (const Side to : {Side::left, Side::right}) offer(v, to, pass);
    const std::int64_t before = score();
    std::int64_t best = before;
    std::size_t bestChanges = 0;
    Move move{};
    for (int without = 0; without < kPatience && next(pass, move); ++without) {
      make(move, pass);
      if (score() >= best) continue;
      best = score();
      bestChanges = changes_.size();
      without = 0;
    }
    while (changes_.size() > bestChanges) {
      const auto [node, from] = changes_.back();
      put(node, from);
      changes_.resize(changes_.size() - 2);
    }
    return best < before;
  }

  const WeightedGraph& graph_;
  std::vector<Side>& side_;
  std::vector<int> beside_[2];  // weight of neighbours on each side
  std::vector<int> lockedIn_;   // pass in which the node left the separator
  std::vector<int> offeredIn_;  // last round in which the node was offered
  int round_ = 0;
  int total_[3] = {0, 0, 0}, largest_ = 0;
  std::priority_queue<Move> queue_[2];
  std::vector<std::pair<int, Side>> changes_;
  std::vector<int> pulled_;
};

// Half the weight around a node, in breadth, on the left; what it touches is the separator.
std::vector<Side> growFrom(const WeightedGraph& graph, int seed) {
  std::vector<Side> side(graph.weight.size(), Side::right);
  std::vector<int> queue{seed};
  std::vector<char> reached(side.size(), 0);
  reached[at(seed)] = 1;
  const int all = std::accumulate(graph.weight.begin(), graph.weight.end(), 0);
  int inside = 0;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    const int v = queue[k];
    if (2 * (inside + graph.weight[at(v)]) > all && inside > 0) {
      side[at(v)] = Side::separator;
      continue;
    }
    inside += graph.weight[at(v)];
    side[at(v)] = Side::left;
    forNeighbours(graph, v, [&](int u, int) {
      if (!reached[at(u)]) queue.push_back(u);
      reached[at(u)] = 1;
    });
  }
  return side;
}

int farthest(const WeightedGraph& graph, int from) {
  std::vector<int> queue{from};
  std::vector<char> reached(graph.weight.size(), 0);
  reached[at(from)] = 1;
  for (std::size_t k = 0; k < queue.size(); ++k)
    forNeighbours(graph, queue[k], [&](int u, int) {
      if (!reached[at(u)]) queue.push_back(u);
      reached[at(u)] = 1;
    });
  return queue.back();
}

std::vector<Side> separateCoarsest(const WeightedGraph& graph) {
  std::vector<Side> best;
  std::int64_t bestScore = 0;
  int seed = farthest(graph, 0);
  for (int k = 0; k < kTries; ++k) {
    std::vector<Side> side = growFrom(graph, seed);
    Refinement refinement(graph, side);
    refinement.run();
    if (best.empty() || refinement.score() < bestScore) {
      bestScore = refinement.score();
      best = std::move(side);
    }
    seed = k == 0 ? farthest(graph, seed) : (k * graph.size()) / kTries;
  }
  return best;
}

// Pairs of neighbours that become one node: those that share the heaviest edges.
std::vector<int> match(const WeightedGraph& graph, Random& random, int& coarseSize) {
  const int n = graph.size();
  std::vector<int> visit(at(n)), coarse(at(n), -1);
  std::iota(visit.begin(), visit.end(), 0);
  // Not std::shuffle: it is not the same everywhere.
  for (int i = n - 1; i > 0; --i)
    std::swap(visit[at(i)], visit[random.next() % static_cast<std::uint64_t>(i + 1)]);
  const int all = std::accumulate(graph.weight.begin(), graph.weight.end(), 0);
  const int heaviest = std::max(2, 3 * all / (2 * kCoarsest));
  coarseSize = 0;
  for (const int v : visit) {
    if (coarse[at(v)] >= 0) continue;
    int partner = -1, best = 0;
    forNeighbours(graph, v, [&](int u, int weight) {
      if (coarse[at(u)] >= 0 || weight <= best) return;
      if (graph.weight[at(u)] + graph.weight[at(v)] > heaviest) return;
      best = weight;
      partner = u;
    });
    coarse[at(v)] = coarseSize;
    if (partner >= 0) coarse[at(partner)] = coarseSize;
    ++coarseSize;
  }
  return coarse;
}

WeightedGraph contract(const WeightedGraph& graph, const std::vector<int>& coarse, int coarseSize) {
  FASCIA_ASSERT(coarse.size() == at(graph.size()) && areBelow(coarse, coarseSize),
                "every node has a coarse one");
  WeightedGraph result;
  result.weight.assign(at(coarseSize), 0);
  std::vector<int> members[2] = {std::vector<int>(at(coarseSize), -1),
                                 std::vector<int>(at(coarseSize), -1)};
  for (int v = 0; v < graph.size(); ++v) {
    const std::size_t c = at(coarse[at(v)]);
    result.weight[c] += graph.weight[at(v)];
    members[members[0][c] < 0 ? 0 : 1][c] = v;
  }
  result.start.reserve(at(coarseSize) + 1);
  result.neighbours.reserve(graph.neighbours.size() / 2);
  result.edgeWeight.reserve(graph.neighbours.size() / 2);
  std::vector<int> place(at(coarseSize), -1);
  for (int c = 0; c < coarseSize; ++c) {
    const int first = result.start.back();
    for (const auto& member : members) {
      if (member[at(c)] < 0) continue;
      forNeighbours(graph, member[at(c)], [&](int u, int weight) {
        const int to = coarse[at(u)];
        if (to == c) return;
        if (place[at(to)] < first) {
          place[at(to)] = static_cast<int>(result.neighbours.size());
          result.neighbours.push_back(to);
          result.edgeWeight.push_back(0);
        }
        result.edgeWeight[at(place[at(to)])] += weight;
      });
    }
    result.start.push_back(static_cast<int>(result.neighbours.size()));
  }
  return result;
}

std::vector<Side> separate(const WeightedGraph& graph, Random& random) {
  if (graph.size() <= kCoarsest) return separateCoarsest(graph);
  int coarseSize = 0;
  const std::vector<int> coarse = match(graph, random, coarseSize);
  // Where hardly anything matches, further levels would cost time and gain nothing.
  if (10 * coarseSize > 9 * graph.size()) return separateCoarsest(graph);
  const std::vector<Side> rough = separate(contract(graph, coarse, coarseSize), random);
  FASCIA_ASSERT(rough.size() == at(coarseSize), "every coarse node has a side");
  std::vector<Side> side(coarse.size());
  for (std::size_t v = 0; v < coarse.size(); ++v) side[v] = rough[at(coarse[v])];
  Refinement(graph, side).run();
  return side;
}

}  // namespace

std::vector<Side> findSeparator(const WeightedGraph& graph) {
  Random random(1);
  return separate(graph, random);
}

}  // namespace fascia::cholesky
