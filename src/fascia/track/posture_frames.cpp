#include <fascia/track/posture_frames.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <fascia/math/rotation_vector.h>

namespace fascia {
namespace {

template <class Vector>
struct Moving {
  Vector value, rate;
};

Eigen::Vector4d inHemisphereOf(const Eigen::Vector4d& q, const Eigen::Vector4d& other) {
  return q.dot(other) < 0 ? Eigen::Vector4d(-q) : q;
}

// A unit quaternion along a path of quaternions that are none: ω = 2 q̇ q*, of the unit one.
JointRotation unitOf(JointId joint, const Moving<Eigen::Vector4d>& path) {
  const double length = path.value.norm();
  const Eigen::Vector4d unit = path.value / length;
  const Eigen::Vector4d rate = (path.rate - unit * unit.dot(path.rate)) / length;
  const Quat q(unit), spin = Quat(rate) * q.conjugate();
  return {joint, q, 2 * spin.vec()};
}

}  // namespace

struct PostureFrames::Place {
  std::array<std::size_t, 4> frames;
  double span_s = 1;            // from frame 1 to 2
  double share = 0;             // of it, [0, 1]
  double beyond_s = 0;          // how far it has gone on after frame 2
  double speed = 1;             // there, of the speed at frame 2; 0 if it stands
  double startSlope, endSlope;  // 1 / time from the frame before 1 to 2, from 1 to the one after 2

  // The cubic of Hermite with tangents from neighbours; beyond it along the last tangent.
  template <class Vector>
  Moving<Vector> along(const std::array<Vector, 4>& p) const {
    const Vector start = span_s * startSlope * (p[2] - p[0]);
    const Vector end = span_s * endSlope * (p[3] - p[1]), way = p[2] - p[1];
    if (share >= 1)
      return {Vector(p[2] + (beyond_s / span_s) * end), Vector((speed / span_s) * end)};
    const Vector c2 = 3 * way - 2 * start - end, c3 = start + end - 2 * way;
    const double s = share;
    return {Vector(p[1] + s * (start + s * (c2 + s * c3))),
            Vector((speed / span_s) * (start + s * (2 * c2 + s * 3 * c3)))};
  }
};

PostureFrames::PostureFrames(const Figure& figure, std::size_t capacity, double coast_s)
    : figure_(figure),
      balls_(figure.skeleton),
      coast_s_(std::max(coast_s, 0.0)),
      ring_(std::max<std::size_t>(capacity, 4)) {}

// The frame to be written; the others are in order around it.
PostureFrames::Frame& PostureFrames::makeRoom(double time_s) {
  std::size_t at = count_;
  while (at > 0 && frame(at - 1).time_s > time_s) --at;
  if (at > 0 && frame(at - 1).time_s == time_s) return frame(at - 1);
  if (count_ == ring_.size()) {
    first_ = (first_ + 1) % ring_.size();
    --count_, --at;
  }
  for (std::size_t i = count_; i > at; --i) std::swap(frame(i), frame(i - 1));
  ++count_;
  return frame(at);
}

void PostureFrames::put(double time_s, const PostureSample& sample) {
  if (!std::isfinite(time_s)) return;
  if (count_ == ring_.size() && time_s < frame(0).time_s) return;
  Frame& room = makeRoom(time_s);
  room.time_s = time_s;
  room.sample = sample;
  admit(figure_, {}, room.sample);
  balls_.read(room.sample.posture, read_);
  room.turns.resize(balls_.size());
  for (std::size_t i = 0; i < read_.size(); ++i) room.turns[i] = read_[i].rotation.coeffs();
}

PostureFrames::Place PostureFrames::place(double time_s) const {
  std::size_t after = 0;
  while (after < count_ && frame(after).time_s <= time_s) ++after;
  const std::size_t last = count_ - 1;
  Place at;
  const bool beyond = after > last;
  const std::size_t a = after == 0 ? 0 : beyond ? (last > 0 ? last - 1 : 0) : after - 1;
  const std::size_t b = after == 0 ? 0 : beyond ? last : after;
  at.frames = {a > 0 && b > a ? a - 1 : a, a, b, b < last ? b + 1 : b};
  const auto time = [&](std::size_t i) { return frame(at.frames[i]).time_s; };
  const auto slope = [](double span_s) { return span_s > 0 ? 1 / span_s : 0; };
  if (b > a) at.span_s = time(2) - time(1);
  at.startSlope = slope(time(2) - time(0));
  at.endSlope = slope(time(3) - time(1));
  if (after == 0) {
    at.speed = 0;
  } else if (!beyond) {
    at.share = (time_s - time(1)) / at.span_s;
  } else {
    // Slower and slower: t − t² / 2T of the way at full speed.
    const double t = std::min(time_s - time(2), coast_s_);
    at.share = 1;
    at.speed = coast_s_ > 0 ? 1 - t / coast_s_ : 0;
    at.beyond_s = coast_s_ > 0 ? t * (1 - 0.5 * t / coast_s_) : 0;
  }
  return at;
}

void PostureFrames::sample(double time_s, PostureSample& out) const {
  Posture& posture = out.posture;
  const std::size_t count = figure_.skeleton.valueCount();
  posture.values.resize(count), posture.rates.resize(count);
  posture.rotations.clear();
  out.parameters.clear();
  figure_.morphs.rest(out.morphs);
  if (empty()) {
    for (std::size_t v = 0; v < count; ++v) {
      posture.values[v] = figure_.skeleton.valueDof(static_cast<int>(v)).rest;
      posture.rates[v] = 0;
    }
    return;
  }
  const Place at = place(std::isfinite(time_s) ? time_s : frame(0).time_s);
  for (std::size_t v = 0; v < count; ++v) {
    std::array<double, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = frame(at.frames[i]).sample.posture.values[v];
    const Moving<double> moving = at.along(p);
    posture.values[v] = moving.value, posture.rates[v] = moving.rate;
  }
  sampleTurns(at, posture);
  figure_.skeleton.clampToLimits(posture);
  sampleMorphs(at, out.morphs);
  sampleParameters(at, out);
}

void PostureFrames::sampleTurns(const Place& at, Posture& posture) const {
  posture.rotations.resize(balls_.size());
  for (std::size_t j = 0; j < balls_.size(); ++j) {
    std::array<Eigen::Vector4d, 4> q;
    for (std::size_t i = 0; i < 4; ++i) q[i] = frame(at.frames[i]).turns[j];
    q[0] = inHemisphereOf(q[0], q[1]);
    q[2] = inHemisphereOf(q[2], q[1]);
    q[3] = inHemisphereOf(q[3], q[2]);
    posture.rotations[j] = unitOf(balls_.joint(j), at.along(q));
  }
}

void PostureFrames::sampleMorphs(const Place& at, MorphPose& out) const {
  for (std::size_t m = 0; m < out.weights.size(); ++m) {
    std::array<double, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = frame(at.frames[i]).sample.morphs.weights[m];
    const Moving<double> moving = at.along(p);
    out.weights[m] = moving.value, out.rates[m] = moving.rate;
  }
  figure_.morphs.admit(out);
}

// Straight between two frames that animate the same; else as the earlier has them.
void PostureFrames::sampleParameters(const Place& at, PostureSample& out) const {
  const auto &before = frame(at.frames[at.share < 1 ? 1 : 2]).sample.parameters,
             &after = frame(at.frames[2]).sample.parameters;
  out.parameters = before;
  const bool same = std::ranges::equal(before, after, [](const auto& x, const auto& y) {
    return x.solid == y.solid && x.parameter == y.parameter;
  });
  for (std::size_t i = 0; i < out.parameters.size(); ++i) {
    Flesh::ParameterOverride& o = out.parameters[i];
    o.rate = o.weightRate_per_s = 0;
    if (!same || at.share >= 1 || at.speed == 0) continue;
    o.rate = (after[i].value - o.value) / at.span_s;
    o.weightRate_per_s = (after[i].weight - o.weight) / at.span_s;
    o.value += at.share * at.span_s * o.rate;
    o.weight += at.share * at.span_s * o.weightRate_per_s;
  }
}

}  // namespace fascia
