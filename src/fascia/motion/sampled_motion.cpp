#include <fascia/motion/sampled_motion.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Where a motion stands still beside a frame, or nearly so beside how it moves at the other side,
// it has jumped or stopped there: its tangent is at most so many times the shorter way, that it
// does not swing over.
constexpr float kSteepest = 50;

// The four frames around a time, the middle two of which enclose it, and how far it is from the
// second to the third.
struct Around {
  std::array<std::size_t, 4> frame;
  float share;
};

Around around(const SampledMotion& motion, double time_s) {
  FASCIA_ASSERT(motion.frameCount() > 0 && motion.rate_hz > 0, "a sampled motion has frames");
  const std::size_t frames = motion.frameCount();
  const auto count = static_cast<double>(frames);
  double frame = time_s * motion.rate_hz;
  if (!std::isfinite(frame)) frame = 0;
  if (motion.loop) {
    frame = std::fmod(frame, count);
    if (frame < 0) frame = std::min(frame + count, std::nextafter(count, 0.0));
  } else {
    frame = std::clamp(frame, 0.0, count - 1);
  }
  const double whole = std::min(std::floor(frame), count - 1);
  const auto now = static_cast<std::size_t>(whole);
  const auto next = [&](std::size_t f) { return f + 1 < frames ? f + 1 : motion.loop ? 0 : f; };
  const std::size_t before = now > 0 ? now - 1 : motion.loop ? frames - 1 : 0;
  return {{before, now, next(now), next(next(now))}, static_cast<float>(frame - whole)};
}

// The tangent at a frame from the ways to and from its neighbours; ends of a motion have one way
// only, which counts for both.
template <class Vector>
Vector tangent(const Vector& to, const Vector& from) {
  const Vector mean = 0.5f * (to + from);
  const float longest = kSteepest * std::sqrt(std::min(to.squaredNorm(), from.squaredNorm()));
  const float length = mean.norm();
  return length > longest ? Vector(longest / length * mean) : mean;
}

// A cubic through the middle two of four values.
template <class Vector>
Vector smooth(const std::array<Vector, 4>& p, const Around& at) {
  const Vector way = p[2] - p[1];
  const Vector before = at.frame[0] == at.frame[1] ? way : Vector(p[1] - p[0]);
  const Vector after = at.frame[2] == at.frame[3] ? way : Vector(p[3] - p[2]);
  const Vector start = tangent(before, way), end = tangent(way, after);
  // Hermite's basis in the form p1 + t (…): exact at t = 0, and where nothing moves.
  const float t = at.share;
  return p[1] + t * (start + t * ((3 * way - 2 * start - end) + t * (start + end - 2 * way)));
}

}  // namespace

Transform sampleJoint(const SampledMotion& motion, std::size_t joint, double time_s) {
  FASCIA_ASSERT(joint < motion.joints.size(), "the motion moves the joint");
  const Around at = around(motion, time_s);
  FASCIA_ASSERT(areBelow(at.frame, motion.frameCount()), "frames around a time are frames");
  FASCIA_ASSERT(at.share >= 0 && at.share <= 1, "a time lies between two frames");
  std::array<Eigen::Vector4f, 4> turns;
  std::array<Eigen::Vector3f, 4> places;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t frame = at.frame[i] * motion.joints.size() + joint;
    turns[i] = motion.rotation[frame].coeffs();
    places[i] = motion.translation_m[frame];
  }
  // q and −q are the same turn: each frame in the hemisphere of the time's own.
  for (std::size_t i : {std::size_t{0}, std::size_t{2}})
    if (turns[i].dot(turns[1]) < 0) turns[i] *= -1;
  if (turns[3].dot(turns[2]) < 0) turns[3] *= -1;
  const Eigen::Quaternionf turn(smooth(turns, at).normalized());
  return {turn.cast<double>().toRotationMatrix(), smooth(places, at).cast<double>()};
}

double sampleWeight(const SampledMotion& motion, std::size_t morph, double time_s) {
  FASCIA_ASSERT(morph < motion.morphs.size(), "the motion has the morph");
  using Number = Eigen::Matrix<float, 1, 1>;
  const Around at = around(motion, time_s);
  std::array<Number, 4> weights;
  for (std::size_t i = 0; i < 4; ++i)
    weights[i][0] = motion.weights[at.frame[i] * motion.morphs.size() + morph];
  return double{smooth(weights, at)[0]};
}

}  // namespace fascia
