#include <fascia/skin/felt_contact.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/field/solid.h>
#include <fascia/skin/point_kernels.h>

namespace fascia {
namespace {

// Limits for selectPairs: pairs that are felt at all, and none.
constexpr float kFelt = 0.1f * kFarAway, kNothing = -3e38f;
// From so many yields of depth on, anchors are not pushed.
constexpr float kYieldsAltogether = 3;
// No point of a surface moves farther than so many times the farthest point of its outline.
constexpr double kOutlineShare = 2;

void load(const VectorArray& from, std::size_t first, std::size_t count, FeltVectors& to) {
  std::copy_n(from.x.data() + first, count, to.x.data());
  std::copy_n(from.y.data() + first, count, to.y.data());
  std::copy_n(from.z.data() + first, count, to.z.data());
  to.x[FleshSense::kChunk] = to.y[FleshSense::kChunk] = to.z[FleshSense::kChunk] = 0;
}

float farthest(const Field::Outline& a, const Field::Outline& b) {
  double squared = 0;
  for (std::size_t c = 0; c < a.size(); ++c)
    squared = std::max(squared, (a[c] - b[c]).squaredNorm());
  return static_cast<float>(std::sqrt(squared));
}

}  // namespace

FeltContact::Memory::Memory(const FleshSense& sense)
    : place(sense.pairCount()),
      lower(sense.pairCount(), -kFarAway),
      upper(sense.pairCount(), kFarAway),
      solids(sense.solids) {}

void FeltContact::Memory::follow(const Field& field) {
  const bool first = outlines.empty();
  outlines.resize(solids.size());
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    const Field::Outline& now = field.outline(id);
    const bool changed = !first && now != outlines[s];
    solids[s].swelling_m =
        changed ? static_cast<float>(kOutlineShare) * farthest(now, outlines[s]) : 0;
    solids[s].frame = kernelFrame(field.frame(id));
    if (first || changed) outlines[s] = now;
  }
}

// One chunk of points against the solids that they feel.
class FeltContact::ChunkContact {
 public:
  ChunkContact(const FleshSense& sense, const Chunk& chunk, const Field& field)
      : sense_(sense),
        chunk_(chunk),
        field_(field),
        groups_(std::span(sense.groups).subspan(chunk.firstGroup, chunk.groups)) {}

  void load(const VectorArray& place, const PointModel& points, float limit) {
    fascia::load(place, chunk_.firstPoint, chunk_.points, lanes_.place);
    std::copy_n(points.fat.data() + chunk_.firstPoint, chunk_.points, lanes_.fat.data());
    lanes_.fat[FleshSense::kChunk] = 0;
    std::fill_n(lanes_.nearest.data(), kFeltSize, kFarAway);
    std::fill_n(lanes_.limit.data(), kFeltSize, limit);
    lanes_.limit[FleshSense::kChunk] = kNothing;
  }

  // Which of a group's pairs are meant.
  enum class Pairs { all, yielding };
  std::span<const std::int32_t> pairsOf(const Group& g, Pairs which) const {
    const std::uint32_t end = which == Pairs::all ? g.end : g.firstFirm;
    return std::span(sense_.point).subspan(g.first, end - g.first);
  }

  // Bounds of all the gaps. With lowered limits, pairs that are not nearest for sure are beyond.
  void bound(Pairs which, Memory& memory, const FloatArray& yield, bool lowerLimits,
             FloatArray& bound) {
    for (const Group& g : groups_)
      boundPairs(memory.solids[g.solid.index()], pairsOf(g, which), of(g, memory, yield),
                 lowerLimits, lanes_, bound.data() + g.first);
  }

  // Asks a solid for the pairs within their limits. Returns whether there are any.
  bool ask(const Group& g, Pairs which, const FloatArray& bound) {
    selectPairs(pairsOf(g, which), bound.data() + g.first, lanes_, batch_);
    if (batch_.count == 0) return false;
    field_.evaluate(g.solid, batch_.place.view(batch_.count), batch_.gap.data(),
                    batch_.answer.view(batch_.count));
    subtractFat(lanes_, batch_);
    return true;
  }
  // Asks every solid; each(group) sees the answer in the batch.
  template <class Each>
  void visit(Pairs which, const FloatArray& bound, const Each& each) {
    for (const Group& g : groups_)
      if (ask(g, which, bound)) each(g);
  }
  // The same for pairs that may be within their limits, and remembers what was found of them.
  template <class Each>
  void visitNear(Pairs which, Memory& memory, const FloatArray& yield, bool lowerLimits,
                 FloatArray& bounds, const Each& each) {
    bound(which, memory, yield, lowerLimits, bounds);
    visit(which, bounds, [&](const Group& g) {
      rememberPairs(memory.solids[g.solid.index()].frame, batch_, of(g, memory, yield));
      each(g);
    });
  }
  static FeltMemory of(const Group& g, Memory& memory, const FloatArray& yield) {
    const std::size_t p = g.first;
    return {{memory.place.x.data() + p, memory.place.y.data() + p, memory.place.z.data() + p},
            memory.lower.data() + p,
            memory.upper.data() + p,
            yield.data() + p};
  }
  void absorb(const Group& g, bool move) {
    absorbPairs(static_cast<float>(g.solid.index()), move, batch_, lanes_);
  }

  // How deep the batch's anchors are. Deep inside of a solid distances are poor estimates: a point
  // whose anchor is deeper than its yield does not feel the solid.
  void measureDepths(const Group& g, FloatArray& depth) {
    for (std::size_t i = 0; i < batch_.count; ++i)
      depth[pair(g, i)] = -batch_.gap[i] < yieldOf(i) ? std::max(0.f, -batch_.gap[i]) : kFarAway;
  }
  // By how much the batch's anchors yield, which makes their gaps wider.
  void yieldGently(const Group& g, FloatArray& yield, FloatArray& bound) {
    for (std::size_t i = 0; i < batch_.count; ++i) {
      const float depth = -batch_.gap[i], most = yieldOf(i);
      if (!(depth > most)) continue;
      const float push = most - (depth - most) / (kYieldsAltogether - 1);
      yield[pair(g, i)] = push > 0 ? depth - push : kFarAway;
      bound[pair(g, i)] += yield[pair(g, i)];
    }
    widen(g, yield);
  }
  void widen(const Group& g, const FloatArray& yield) {
    if (g.firstFirm == g.first) return;
    for (std::size_t i = 0; i < batch_.count; ++i) batch_.gap[i] += yield[pair(g, i)];
  }

  // Moves points that are inside of any solid out of all that they feel, in turn. Returns the
  // longest way. First only solids within a point's yield are asked, which few points leave; then,
  // for those, all. `busy` is scratch; `prepare` may change the gaps of a batch.
  template <class Prepare>
  float leaveSolids(Pairs which, const FloatArray& bound, std::span<char> busy,
                    const Prepare& prepare) {
    float longest = 0;
    for (const bool all : {false, true}) {
      std::size_t moving = beginMoving(all);
      std::fill(busy.begin(), busy.end(), char{1});
      for (int pass = 0; pass < kPasses && moving > 0; ++pass) {
        beginPass();
        for (std::size_t g = 0; g < groups_.size(); ++g) {
          busy[g] = busy[g] && ask(groups_[g], which, bound);
          if (!busy[g]) continue;
          prepare(groups_[g]);
          absorb(groups_[g], true);
        }
        moving = endPass(longest);
      }
    }
    return longest;
  }

  void store(VectorArray& place) const {
    for (std::size_t p = 0; p < chunk_.points; ++p) {
      if (!inside_[p]) continue;
      const std::size_t k = chunk_.firstPoint + p;
      place.x[k] = lanes_.place.x[p];
      place.y[k] = lanes_.place.y[p];
      place.z[k] = lanes_.place.z[p];
    }
  }

  // Of the nearest solid's matter at points within reach of it.
  void readFleshVelocities(float reach_m) {
    for (std::size_t p = 0; p < chunk_.points; ++p) lanes_.limit[p] = inside_[p] ? kFelt : reach_m;
    for (const Group& g : groups_) {
      selectNearest(pairsOf(g, Pairs::all), static_cast<float>(g.solid.index()), lanes_, batch_);
      if (batch_.count == 0) continue;
      field_.velocity(g.solid, batch_.place.view(batch_.count), batch_.answer.view(batch_.count));
      for (std::size_t i = 0; i < batch_.count; ++i) {
        const std::size_t p = point(i);
        lanes_.fleshVelocity.x[p] = batch_.answer.x[i];
        lanes_.fleshVelocity.y[p] = batch_.answer.y[i];
        lanes_.fleshVelocity.z[p] = batch_.answer.z[i];
      }
    }
  }
  ContactFindings findings() {
    const std::size_t n = chunk_.points;
    return {lanes_.place.view(n), lanes_.nearest.data(), lanes_.nearestNormal.view(n),
            lanes_.fleshVelocity.view(n)};
  }
  const FeltBatch& batch() const { return batch_; }

 private:
  std::size_t point(std::size_t i) const { return static_cast<std::size_t>(batch_.point[i]); }

  std::size_t pair(const Group& g, std::size_t i) const {
    return g.first + static_cast<std::size_t>(batch_.pair[i]);
  }
  float yieldOf(std::size_t i) const { return sense_.yield_m[chunk_.firstPoint + point(i)]; }

  // Sets the points that are inside of a solid moving (all = false), then those that have left the
  // reach of what was asked. Returns how many.
  std::size_t beginMoving(bool all) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < chunk_.points; ++p) {
      const float reach = sense_.yield_m[chunk_.firstPoint + p];
      if (!all) {
        inside_[p] = lanes_.nearest[p] <= 0;
        lanes_.pushNormal.x[p] = lanes_.pushNormal.y[p] = lanes_.pushNormal.z[p] = 0;
        lanes_.way[p] = 0;
      }
      moving_[p] = inside_[p] && (!all || lanes_.way[p] > reach);
      lanes_.limit[p] = !moving_[p] ? kNothing : all ? kFelt : reach;
      count += moving_[p] ? 1 : 0;
    }
    return count;
  }
  void beginPass() {
    for (std::size_t p = 0; p < chunk_.points; ++p)
      if (moving_[p]) lanes_.nearest[p] = kFarAway, lanes_.pushed[p] = 0;
  }
  // Points that have hardly been pushed are done. Returns how many are not.
  std::size_t endPass(float& longest) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < chunk_.points; ++p) {
      if (!moving_[p]) continue;
      lanes_.way[p] += lanes_.pushed[p];
      longest = std::max(longest, lanes_.way[p]);
      moving_[p] = lanes_.pushed[p] > kRetest_m;
      if (!moving_[p]) lanes_.limit[p] = kNothing;
      count += moving_[p] ? 1 : 0;
    }
    return count;
  }

  const FleshSense& sense_;
  const Chunk& chunk_;
  const Field& field_;
  std::span<const Group> groups_;
  FeltLanes lanes_;
  FeltBatch batch_;
  std::array<bool, FleshSense::kChunk> inside_, moving_;
};

FeltContact::FeltContact(const FleshSense& sense)
    : sense_(&sense),
      points_(sense),
      anchors_(sense),
      yield_(sense.pairCount(), 0.f),
      noYield_(yield_),
      bound_(yield_),
      busy_(sense.groups.size()),
      results_(sense.chunks.size()) {}

void FeltContact::projectAnchors(const Field& field, const PointModel& points,
                                 VectorArray& anchor) {
  anchors_.follow(field);
  yield_ = noYield_;
  parallelFor(sense_->chunks.size(), [&](std::size_t c) {
    const Chunk& run = sense_->chunks[c];
    ChunkContact chunk(*sense_, run, field);
    using Pairs = ChunkContact::Pairs;
    chunk.load(anchor, points, 0);
    chunk.visitNear(Pairs::yielding, anchors_, noYield_, false, bound_, [&](const Group& g) {
      chunk.yieldGently(g, yield_, bound_);
      chunk.absorb(g, false);
    });
    chunk.leaveSolids(Pairs::yielding, bound_, busy(run),
                      [&](const Group& g) { chunk.widen(g, yield_); });
    chunk.store(anchor);
  });
}

void FeltContact::findYielding(const Field& field, const PointModel& points,
                               const VectorArray& anchor) {
  yield_ = noYield_;
  if (anchor.size() == 0) return;
  anchors_.follow(field);
  parallelFor(sense_->chunks.size(), [&](std::size_t c) {
    ChunkContact chunk(*sense_, sense_->chunks[c], field);
    using Pairs = ChunkContact::Pairs;
    chunk.load(anchor, points, 0);
    chunk.visitNear(Pairs::yielding, anchors_, noYield_, false, bound_,
                    [&](const Group& g) { chunk.measureDepths(g, yield_); });
  });
}

FeltContact::Result FeltContact::project(const Field& field, const PointModel& points,
                                         float reach_m, float restitution, VectorArray& position,
                                         VectorArray& velocity, PointSurroundings& around) {
  points_.follow(field);
  parallelFor(sense_->chunks.size(), [&](std::size_t c) {
    const Chunk& run = sense_->chunks[c];
    ChunkContact chunk(*sense_, run, field);
    using Pairs = ChunkContact::Pairs;
    chunk.load(position, points, reach_m);
    chunk.visitNear(Pairs::all, points_, yield_, true, bound_, [&](const Group& g) {
      chunk.widen(g, yield_);
      chunk.absorb(g, false);
    });
    results_[c].maxCorrection_m = chunk.leaveSolids(
        Pairs::all, bound_, busy(run), [&](const Group& g) { chunk.widen(g, yield_); });
    chunk.readFleshVelocities(reach_m);
    const PointBlock block{run.firstPoint, static_cast<std::uint32_t>(run.points)};
    results_[c].maxSpeed_m_per_s = finishContact(block, true, reach_m, restitution, points,
                                                 chunk.findings(), position, velocity, around);
  });
  return largest(results_);
}

float FeltContact::deepest(const Field& field, const PointModel& points,
                           const VectorArray& position) const {
  float depth = 0;
  for (const Chunk& run : sense_->chunks) {
    ChunkContact chunk(*sense_, run, field);
    chunk.load(position, points, 0);
    chunk.visit(ChunkContact::Pairs::all, noYield_, [&](const Group& g) {
      chunk.widen(g, yield_);
      for (std::size_t i = 0; i < chunk.batch().count; ++i)
        depth = std::max(depth, -chunk.batch().gap[i]);
    });
  }
  return depth;
}

}  // namespace fascia
