#include <fascia/skin/contact/face_lift.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

// How far samples go in each pass, as a share of their depth: in small ways first, so that faces
// side by side share them, and what is left at last.
constexpr float kShares[] = {0.4f, 0.4f, 0.5f, 0.7f, 1, 1};
constexpr float kEnough_m = 1e-5f;
// A sample whose free points have hardly a share in it is left where it is.
constexpr float kLeastShare = 0.05f;
constexpr std::size_t kLanes = 32;

using Sample = FaceSamples::Sample;
using Block = FaceSamples::Block;

Eigen::Vector3f placeOf(const Sample& sample, const VectorArray& position) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t c = 0; c < 3; ++c)
    sum += sample.weights[c] * floatPointAt(position, sample.corners[c]);
  return sum;
}

class FaceLift {
 public:
  FaceLift(const FaceSamples& faces, const DistanceField& flesh, const PointModel& points,
           float clearance_m, VectorArray& position)
      : faces_(faces),
        flesh_(flesh),
        points_(points),
        clearance_m_(clearance_m),
        position_(position),
        cuts_(faces.samples.size()),
        isCut_(faces.blocks.size()),
        moved_(position.size(), 1) {
    for (std::size_t s = 0; s < flesh.solidCount(); ++s)
      bounds_.push_back(flesh.bounds(SolidId(static_cast<std::int64_t>(s))));
  }

  // Whether anything had to be moved.
  bool pass(float way) {
    parallelFor(faces_.blocks.size(), [&](std::size_t b) { isCut_[b] = search(faces_.blocks[b]); });
    std::ranges::fill(moved_, 0);
    bool any = false;
    for (std::size_t b = 0; b < isCut_.size(); ++b) {
      if (!isCut_[b]) continue;
      any = true;
      const Block& block = faces_.blocks[b];
      for (std::size_t i = block.firstSample; i < block.firstSample + block.sampleCount; ++i)
        pushOut(faces_.samples[i], cuts_[i], way);
    }
    return any;
  }

 private:
  // The deepest of a sample.
  struct Cut {
    Eigen::Vector3f place, normal;
    float depth_m;
  };

  // Whether a sample of a block is inside, if its points have moved since it was last looked at.
  bool search(const Block& block) {
    Box box;
    bool moved = false;
    for (std::size_t i = block.firstPoint; i < block.firstPoint + block.pointCount; ++i) {
      box.add(pointAt(position_, faces_.points[i]));
      moved |= moved_[faces_.points[i]] != 0;
    }
    if (!moved) return false;
    for (std::size_t i = block.firstSample; i < block.firstSample + block.sampleCount; ++i)
      cuts_[i] = {placeOf(faces_.samples[i], position_), Eigen::Vector3f::Zero(), 0};
    bool inside = false;
    for (std::size_t s = 0; s < bounds_.size(); ++s)
      if ((box.low.array() - clearance_m_ <= bounds_[s].high.array()).all() &&
          (box.high.array() + clearance_m_ >= bounds_[s].low.array()).all())
        inside |= test(SolidId(static_cast<std::int64_t>(s)), block);
    return inside;
  }

  bool test(SolidId solid, const Block& block) {
    struct alignas(64) Lanes3 {
      std::array<float, kLanes> x, y, z;
      Vectors view(std::size_t n) { return {x.data(), y.data(), z.data(), n}; }
    };
    Lanes3 place, normal;
    alignas(64) std::array<float, kLanes> distance;
    bool inside = false;
    const std::size_t end = block.firstSample + block.sampleCount;
    for (std::size_t first = block.firstSample; first < end; first += kLanes) {
      const std::size_t count = std::min(kLanes, end - first);
      for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3f& p = cuts_[first + i].place;
        place.x[i] = p.x(), place.y[i] = p.y(), place.z[i] = p.z();
      }
      flesh_.evaluate(solid, place.view(count), distance.data(), normal.view(count));
      for (std::size_t i = 0; i < count; ++i) {
        Cut& cut = cuts_[first + i];
        const float depth = keep_m(faces_.samples[first + i]) - distance[i];
        if (!(depth > cut.depth_m)) continue;
        cut.depth_m = depth;
        cut.normal = {normal.x[i], normal.y[i], normal.z[i]};
        inside |= depth > kEnough_m;
      }
    }
    return inside;
  }

  float keep_m(const Sample& sample) const {
    float fat = 0;
    for (std::size_t c = 0; c < 3; ++c) fat += sample.weights[c] * points_.fat[sample.corners[c]];
    return std::min(clearance_m_, fat);
  }

  // Moves the points that a sample lies between, as far as those before have not done so; each by
  // its share, so that the sum of their squared ways is least.
  void pushOut(const Sample& sample, const Cut& cut, float way) {
    const float depth = way * cut.depth_m - cut.normal.dot(placeOf(sample, position_) - cut.place);
    if (!(cut.depth_m > kEnough_m && depth > 0)) return;
    std::array<float, 3> share;
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      share[c] = sample.weights[c] * points_.free[sample.corners[c]];
      sum += share[c] * sample.weights[c];
    }
    if (sum < kLeastShare) return;
    for (std::size_t c = 0; c < 3; ++c) {
      if (share[c] == 0) continue;
      const std::uint32_t k = sample.corners[c];
      const Eigen::Vector3f step = depth * share[c] / sum * cut.normal;
      position_.x[k] += step.x(), position_.y[k] += step.y(), position_.z[k] += step.z();
      moved_[k] = 1;
    }
  }

  const FaceSamples& faces_;
  const DistanceField& flesh_;
  const PointModel& points_;
  float clearance_m_;
  VectorArray& position_;
  std::vector<Box> bounds_;  // of the solids
  std::vector<Cut> cuts_;    // per sample
  std::vector<char> isCut_;  // per block
  std::vector<char> moved_;  // per point, by the last pass
};

// Takes back what of a lift would stretch edges too far. Of each edge the shares of both ends'
// ways that keep it short enough are found, each point takes the least of its edges, and since the
// two ends of an edge may then have taken different ones, this is repeated.
class LiftLimit {
 public:
  LiftLimit(const FaceSamples& faces, float stretch, const VectorArray& before,
            VectorArray& position)
      : faces_(faces),
        stretch_(stretch),
        before_(before),
        position_(position),
        share_(position.size(), 1) {}

  void apply() {
    for (int round = 0; round < kMostRounds && shorten(); ++round) {
    }
  }

 private:
  static constexpr int kMostRounds = 12;

  // Whether an edge was too long.
  bool shorten() {
    bool any = false;
    for (const FaceSamples::Edge& edge : faces_.edges) {
      const float share = shareOf(edge);
      if (share >= 1) continue;
      any = true;
      for (const std::uint32_t k : edge.ends) share_[k] = std::min(share_[k], share);
    }
    if (!any) return false;
    for (std::size_t k = 0; k < share_.size(); ++k) {
      if (share_[k] == 1) continue;
      for (const auto axis : VectorArray::kAxes) {
        const float start = (before_.*axis)[k];
        (position_.*axis)[k] = start + share_[k] * ((position_.*axis)[k] - start);
      }
      share_[k] = 1;
    }
    return true;
  }

  // The largest s ≤ 1 with |a + s (b − a)| no longer than the edge may be, from a before to b now.
  float shareOf(const FaceSamples::Edge& edge) const {
    const auto along = [&](const VectorArray& r) -> Eigen::Vector3f {
      return floatPointAt(r, edge.ends[1]) - floatPointAt(r, edge.ends[0]);
    };
    const Eigen::Vector3f now = along(position_);
    const float most = stretch_ * edge.rest_m, most2 = most * most;
    if (now.squaredNorm() <= most2 * kEven) return 1;
    const Eigen::Vector3f start = along(before_), way = now - start;
    const float a = way.squaredNorm(), b = start.dot(way);
    const float c = start.squaredNorm() - std::max(most2, start.squaredNorm());
    if (a == 0 || now.squaredNorm() <= start.squaredNorm() * kEven) return 1;
    return std::clamp((std::sqrt(std::max(0.f, b * b - a * c)) - b) / a, 0.f, 1.f);
  }

  // Rounding is no stretch.
  static constexpr float kEven = 1.0001f;

  const FaceSamples& faces_;
  float stretch_;
  const VectorArray& before_;
  VectorArray& position_;
  std::vector<float> share_;  // per point
};

}  // namespace

void liftFaces(const FaceSamples& faces, const DistanceField& flesh, const PointModel& points,
               float clearance_m, double most_stretch, VectorArray& position) {
  FASCIA_ASSERT(points.fat.size() == position.size() && points.free.size() == position.size(),
                "a number for each point");
  const VectorArray before = position;
  FaceLift lift(faces, flesh, points, clearance_m, position);
  if (!lift.pass(kShares[0])) return;
  for (const float way : std::span(kShares).subspan(1))
    if (!lift.pass(way)) break;
  LiftLimit(faces, static_cast<float>(most_stretch), before, position).apply();
}

}  // namespace fascia
