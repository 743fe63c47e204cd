#include <fascia/skin/contact/face_contact.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

constexpr float kEnough_m = 1e-5f;
// A sample whose free points have hardly a share in it is left where it is.
constexpr float kLeastShare = 0.05f;
constexpr std::size_t kLanes = 32;

Eigen::Vector3f blend(const FaceSamples::Sample& sample, const VectorArray& of) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint32_t k = sample.corners[c];
    sum += sample.weights[c] * Eigen::Vector3f(of.x[k], of.y[k], of.z[k]);
  }
  return sum;
}

float blend(const FaceSamples::Sample& sample, const FloatArray& of) {
  float sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += sample.weights[c] * of[sample.corners[c]];
  return sum;
}

bool near(const Box& a, const Box& b, double reach) {
  return ((a.low.array() - reach) <= b.high.array()).all() &&
         ((a.high.array() + reach) >= b.low.array()).all();
}

}  // namespace

FaceContact::FaceContact(std::shared_ptr<const FaceSamples> samples, float clearance_m)
    : samples_(std::move(samples)), clearance_m_(clearance_m) {
  last_.resize(samples_->points.size());
  found_.resize(samples_->blocks.size());
  cuts_.resize(samples_->samples.size());
  keep_m_.resize(samples_->samples.size());
}

void FaceContact::project(const MovingField& field, const PointModel& points, VectorArray& position,
                          VectorArray& velocity) {
  FASCIA_ASSERT(velocity.size() == position.size() && points.fat.size() == position.size(),
                "a number for each point");
  search(field, points, position);
  for (std::size_t b = 0; b < samples_->blocks.size(); ++b) {
    if (found_[b] != kCut) continue;
    const FaceSamples::Block& block = samples_->blocks[b];
    for (std::size_t i = block.firstSample; i < block.firstSample + block.sampleCount; ++i)
      pushOut(field, samples_->samples[i], cuts_[i], points, position, velocity);
  }
}

// Finds which samples are inside.
void FaceContact::search(const MovingField& field, const PointModel& points,
                         const VectorArray& position) {
  const std::size_t solids = field.solidCount();
  boxes_.resize(solids);
  for (std::size_t s = 0; s < solids; ++s)
    boxes_[s] = field.bounds(SolidId(static_cast<std::int64_t>(s)));
  if (!motions_.follow(field))
    gaps_.assign(samples_->blocks.size() * solids, SolidMotions::kUnknown);
  parallelFor(samples_->blocks.size(),
              [&](std::size_t b) { searchBlock(field, points, b, position); });
}

void FaceContact::searchBlock(const MovingField& field, const PointModel& points, std::size_t b,
                              const VectorArray& position) {
  const FaceSamples::Block& block = samples_->blocks[b];
  Box box;
  const BlockMotion motion = follow(block, position, box);
  found_[b] = kFar;
  const std::size_t solids = boxes_.size();
  for (std::size_t s = 0; s < solids; ++s) {
    float& gap = gaps_[b * solids + s];
    gap = motions_.left(gap, motion, s);
    if (gap > 0 || !near(box, boxes_[s], double{clearance_m_})) continue;
    if (found_[b] == kFar) {
      for (std::size_t i = block.firstSample; i < block.firstSample + block.sampleCount; ++i) {
        const FaceSamples::Sample& sample = samples_->samples[i];
        cuts_[i] = {blend(sample, position), Eigen::Vector3f::Zero(), 0, SolidId()};
        keep_m_[i] = std::min(clearance_m_, blend(sample, points.fat));
      }
      found_[b] = kNear;
    }
    testSolid(field, SolidId(static_cast<std::int64_t>(s)), block, gap);
    if (gap < -kEnough_m) found_[b] = kCut;
  }
}

// How the block's points went since the last search.
BlockMotion FaceContact::follow(const FaceSamples::Block& block, const VectorArray& position,
                                Box& box) {
  Eigen::Vector3f center = Eigen::Vector3f::Zero(), way = Eigen::Vector3f::Zero();
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e30f), high = -low;
  const auto now = [&](std::size_t i) {
    const std::uint32_t k = samples_->points[i];
    return Eigen::Vector3f(position.x[k], position.y[k], position.z[k]);
  };
  const auto before = [&](std::size_t i) {
    return Eigen::Vector3f(last_.x[i], last_.y[i], last_.z[i]);
  };
  const std::size_t end = block.firstPoint + block.pointCount;
  for (std::size_t i = block.firstPoint; i < end; ++i) {
    const Eigen::Vector3f p = now(i);
    low = low.cwiseMin(p), high = high.cwiseMax(p);
    center += before(i), way += p - before(i);
  }
  const float share = 1 / static_cast<float>(block.pointCount);
  center *= share, way *= share;
  float radius = 0, spread = 0;
  for (std::size_t i = block.firstPoint; i < end; ++i) {
    const Eigen::Vector3f p = now(i), from = before(i);
    radius = std::max(radius, (from - center).squaredNorm());
    spread = std::max(spread, (p - from - way).squaredNorm());
    last_.x[i] = p.x(), last_.y[i] = p.y(), last_.z[i] = p.z();
  }
  box.add(low.cast<double>()), box.add(high.cast<double>());
  return {{center.x(), center.y(), center.z()},
          {way.x(), way.y(), way.z()},
          std::sqrt(radius),
          std::sqrt(spread)};
}

// Keeps the deepest cut of every sample.
void FaceContact::testSolid(const MovingField& field, SolidId solid,
                            const FaceSamples::Block& block, float& gap_m) {
  struct alignas(64) Lanes3 {
    std::array<float, kLanes> x, y, z;
    Vectors view(std::size_t n) { return {x.data(), y.data(), z.data(), n}; }
  };
  Lanes3 place, normal;
  alignas(64) std::array<float, kLanes> distance;
  gap_m = 1e30f;
  const std::size_t end = block.firstSample + block.sampleCount;
  for (std::size_t first = block.firstSample; first < end; first += kLanes) {
    const std::size_t count = std::min(kLanes, end - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f& p = cuts_[first + i].place;
      place.x[i] = p.x(), place.y[i] = p.y(), place.z[i] = p.z();
    }
    field.evaluate(solid, place.view(count), distance.data(), normal.view(count));
    for (std::size_t i = 0; i < count; ++i) {
      const float gap = distance[i] - keep_m_[first + i];
      gap_m = std::min(gap_m, gap);
      Cut& cut = cuts_[first + i];
      if (!(-gap > cut.depth_m)) continue;
      cut.depth_m = -gap, cut.solid = solid;
      cut.normal = Eigen::Vector3f(normal.x[i], normal.y[i], normal.z[i]);
    }
  }
}

// Moves the points that a sample lies between, as far as those before have not done so; each by
// its share, so that the sum of their ways is least. What they approach the flesh with is lost.
void FaceContact::pushOut(const MovingField& field, const FaceSamples::Sample& sample,
                          const Cut& cut, const PointModel& points, VectorArray& position,
                          VectorArray& velocity) const {
  if (!(cut.depth_m > kEnough_m)) return;
  std::array<float, 3> share;
  float sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    share[c] = sample.weights[c] * points.free[sample.corners[c]];
    sum += share[c] * sample.weights[c];
  }
  if (sum < kLeastShare) return;
  const auto move = [&](VectorArray& values, float way) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t k = sample.corners[c];
      const Eigen::Vector3f step = way * share[c] / sum * cut.normal;
      values.x[k] += step.x(), values.y[k] += step.y(), values.z[k] += step.z();
    }
  };
  const float depth = cut.depth_m - cut.normal.dot(blend(sample, position) - cut.place);
  if (depth > 0) move(position, depth);

  Eigen::Vector3f at = cut.place, flesh = Eigen::Vector3f::Zero();
  field.velocity(cut.solid, {&at.x(), &at.y(), &at.z(), 1},
                 {&flesh.x(), &flesh.y(), &flesh.z(), 1});
  const float approach = cut.normal.dot(blend(sample, velocity) - flesh);
  if (approach < 0) move(velocity, -approach);
}

}  // namespace fascia
