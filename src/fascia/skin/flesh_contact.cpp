#include <fascia/skin/flesh_contact.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

constexpr std::size_t kLanes = PointBlock::kCapacity;
// A projection larger than this makes a block with several solids be tested again.
constexpr float kRetest_m = 1e-5f;
// Blocks handed to a thread at once; smaller skins are not worth waking threads for.
constexpr std::size_t kBlocksPerTask = 128;

struct Lanes3 {
  alignas(64) std::array<float, kLanes> x, y, z;
  Vectors view(std::size_t n) { return {x.data(), y.data(), z.data(), n}; }
};

struct FloatBox {
  float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
};

FloatBox boxOf(const Lanes3& p, std::size_t n) {
  FloatBox box;
  const float* axes[3] = {p.x.data(), p.y.data(), p.z.data()};
  for (int a = 0; a < 3; ++a) {
    for (std::size_t l = 0; l < n; ++l) {
      box.low[a] = std::min(box.low[a], axes[a][l]);
      box.high[a] = std::max(box.high[a], axes[a][l]);
    }
  }
  return box;
}

bool near(const FloatBox& a, const Box& b, float reach) {
  for (int k = 0; k < 3; ++k)
    if (a.low[k] - reach > b.high[k] || a.high[k] + reach < b.low[k]) return false;
  return true;
}

// The inner side of the skin: r − τ n (spec L10).
void loadInner(const PointBlock& b, const VectorArray& r, const VectorArray& n,
               const FloatArray& fat, Lanes3& out) {
  for (std::size_t l = 0; l < b.count; ++l) {
    const std::size_t k = b.first + l;
    out.x[l] = r.x[k] - fat[k] * n.x[k];
    out.y[l] = r.y[k] - fat[k] * n.y[k];
    out.z[l] = r.z[k] - fat[k] * n.z[k];
  }
}

}  // namespace

FleshContact::FleshContact(std::vector<PointBlock> blocks)
    : blocks_(std::move(blocks)), results_(blocks_.size()) {}

// One block's work: the solids near it, and the nearest surface of each point.
struct FleshContact::Task {
  const Field& field;
  const PointBlock& block;
  float reach;
  Lanes3 inner{}, normal{}, nearestNormal{}, fleshVelocity{};
  std::array<float, kLanes> distance{}, nearest{};
  std::array<std::int32_t, kLanes> nearestSolid{};
  std::span<std::int32_t> solids = {};  // scratch for as many as the field has
  std::size_t solidCount = 0;

  // Returns false when no solid is within reach.
  bool findSolids(const std::vector<Box>& boxes) {
    const FloatBox box = boxOf(inner, block.count);
    for (std::size_t s = 0; s < boxes.size(); ++s)
      if (near(box, boxes[s], reach)) solids[solidCount++] = static_cast<std::int32_t>(s);
    return solidCount > 0;
  }

  // Visits every solid once, moving points out of it at once. Returns the largest correction.
  float visit(float* depthOnly) {
    nearest.fill(1e30f);
    float largest = 0;
    for (std::size_t q = 0; q < solidCount; ++q) {
      field.evaluate(SolidId(solids[q]), inner.view(block.count), distance.data(),
                     normal.view(block.count));
      for (std::size_t l = 0; l < block.count; ++l) {
        float d = distance[l];
        if (d < 0) {
          largest = std::max(largest, -d);
          if (!depthOnly) {
            inner.x[l] -= d * normal.x[l];
            inner.y[l] -= d * normal.y[l];
            inner.z[l] -= d * normal.z[l];
          }
          d = 0;
        }
        if (d < nearest[l]) {
          nearest[l] = d;
          nearestSolid[l] = solids[q];
          nearestNormal.x[l] = normal.x[l];
          nearestNormal.y[l] = normal.y[l];
          nearestNormal.z[l] = normal.z[l];
        }
      }
    }
    if (depthOnly) *depthOnly = std::max(*depthOnly, largest);
    return largest;
  }

  void readFleshVelocities() {
    Lanes3 velocity;
    for (std::size_t q = 0; q < solidCount; ++q) {
      const auto isNearest = [&](std::size_t l) {
        return nearestSolid[l] == solids[q] && nearest[l] <= reach;
      };
      std::size_t users = 0;
      for (std::size_t l = 0; l < block.count; ++l) users += isNearest(l);
      if (users == 0) continue;
      field.velocity(SolidId(solids[q]), inner.view(block.count), velocity.view(block.count));
      for (std::size_t l = 0; l < block.count; ++l) {
        if (!isNearest(l)) continue;
        fleshVelocity.x[l] = velocity.x[l];
        fleshVelocity.y[l] = velocity.y[l];
        fleshVelocity.z[l] = velocity.z[l];
      }
    }
  }
};

FleshContact::Result FleshContact::project(const Field& field, const PointModel& points,
                                           const VectorArray& skinNormal, float reach_m,
                                           float restitution, VectorArray& position,
                                           VectorArray& velocity, PointSurroundings& around) {
  boxes_.resize(field.solidCount());
  for (std::size_t s = 0; s < boxes_.size(); ++s)
    boxes_[s] = field.bounds(SolidId(std::int64_t(s)));

  const std::size_t tasks = (blocks_.size() + kBlocksPerTask - 1) / kBlocksPerTask;
  nearbySolids_.resize(tasks * boxes_.size());

  const auto projectBlock = [&](std::size_t b, std::span<std::int32_t> scratch) {
    const PointBlock& block = blocks_[b];
    Result& result = results_[b];
    result = {};
    Task task{field, block, reach_m};
    task.solids = scratch;
    loadInner(block, position, skinNormal, points.fat, task.inner);
    const bool any = task.findSolids(boxes_);
    const Lanes3 before = task.inner;
    for (int pass = 0; any && pass < kPasses; ++pass) {
      const float correction = task.visit(nullptr);
      result.maxCorrection_m = std::max(result.maxCorrection_m, correction);
      if (correction < kRetest_m || task.solidCount == 1) break;
    }
    if (any) task.readFleshVelocities();
    for (std::size_t l = 0; l < block.count; ++l) {
      const std::size_t k = block.first + l;
      const bool touching = any && task.nearest[l] <= reach_m && points.free[k] > 0;
      const float n[3] = {touching ? task.nearestNormal.x[l] : 0.f,
                          touching ? task.nearestNormal.y[l] : 0.f,
                          touching ? task.nearestNormal.z[l] : 0.f};
      const float u[3] = {touching ? task.fleshVelocity.x[l] : 0.f,
                          touching ? task.fleshVelocity.y[l] : 0.f,
                          touching ? task.fleshVelocity.z[l] : 0.f};
      const float moved[3] = {task.inner.x[l] - before.x[l], task.inner.y[l] - before.y[l],
                              task.inner.z[l] - before.z[l]};
      float* r[3] = {&position.x[k], &position.y[k], &position.z[k]};
      float* v[3] = {&velocity.x[k], &velocity.y[k], &velocity.z[k]};
      if (touching && task.nearest[l] <= 0) {
        float along = 0;
        for (int a = 0; a < 3; ++a) *r[a] += moved[a], along += n[a] * (*v[a] - u[a]);
        if (along < 0)
          for (int a = 0; a < 3; ++a) *v[a] -= (1 + restitution) * along * n[a];
      }
      float level = 0, speed = 0;
      for (int a = 0; a < 3; ++a) level += n[a] * *r[a], speed += *v[a] * *v[a];
      around.normal.x[k] = n[0], around.normal.y[k] = n[1], around.normal.z[k] = n[2];
      around.fleshVelocity.x[k] = u[0];
      around.fleshVelocity.y[k] = u[1];
      around.fleshVelocity.z[k] = u[2];
      around.offset[k] = touching ? level - task.nearest[l] : 0.f;
      result.maxSpeed_m_per_s = std::max(result.maxSpeed_m_per_s, speed);
    }
  };
  parallelFor(tasks, [&](std::size_t t) {
    const std::span scratch(nearbySolids_.data() + t * boxes_.size(), boxes_.size());
    const std::size_t end = std::min(blocks_.size(), (t + 1) * kBlocksPerTask);
    for (std::size_t b = t * kBlocksPerTask; b < end; ++b) projectBlock(b, scratch);
  });

  Result total;
  for (const Result& r : results_) {
    total.maxCorrection_m = std::max(total.maxCorrection_m, r.maxCorrection_m);
    total.maxSpeed_m_per_s = std::max(total.maxSpeed_m_per_s, r.maxSpeed_m_per_s);
  }
  total.maxSpeed_m_per_s = std::sqrt(total.maxSpeed_m_per_s);
  return total;
}

float FleshContact::deepest(const Field& field, const PointModel& points,
                            const VectorArray& skinNormal, const VectorArray& position) const {
  std::vector<Box> boxes(field.solidCount());
  for (std::size_t s = 0; s < boxes.size(); ++s) boxes[s] = field.bounds(SolidId(std::int64_t(s)));
  std::vector<std::int32_t> nearby(boxes.size());
  float depth = 0;
  for (const PointBlock& block : blocks_) {
    Task task{field, block, 0.f};
    task.solids = nearby;
    loadInner(block, position, skinNormal, points.fat, task.inner);
    if (task.findSolids(boxes)) task.visit(&depth);
  }
  return depth;
}

}  // namespace fascia
