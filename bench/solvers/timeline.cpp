#include "solvers/timeline.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include <fascia/skin/contact/flesh_contact.h>

#include "solvers/scalar_point.h"

namespace fascia {
namespace {

// Processor time of this thread: other work on the machine does not count.
double now_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Does what SkinStepper does around its leapfrog, with another scheme in its place.
class SchemeRunner {
 public:
  SchemeRunner(const Character& character, const SkinState& start, int motion, Scheme& scheme)
      : character_(character),
        skin_(*character.skin()),
        motion_(motion),
        scheme_(scheme),
        contact_(skin_.blocks()),
        position_(start.position),
        velocity_(start.velocity) {
    around_.resize(skin_.grid()->layout().storage());
    nextAnchor_.resize(skin_.grid()->layout().storage());
    poseLayers(character_, character_.source(motion_), true, state_);
    skin_.grid()->anchors().place(state_.flesh, scratch_, around_.anchor);
    project(skin_.settings().interval_s);
  }

  void frame(int stepsPerFrame, Trajectory& out) {
    const int intervals =
        std::max(1, static_cast<int>(std::ceil(kFrame_s / skin_.settings().interval_s - 1e-6)));
    const int steps = (stepsPerFrame + intervals - 1) / intervals;
    for (int n = 0; n < intervals; ++n) {
      const double duration_s = kFrame_s / intervals;
      state_.time_s += duration_s;
      poseLayers(character_, character_.source(motion_), true, state_);
      moveAnchors(static_cast<float>(1 / duration_s));
      const double begin_s = now_s();
      scheme_.run({&around_, duration_s, steps}, position_, velocity_);
      out.stepping_s += now_s() - begin_s;
      out.steps += steps;
      std::swap(around_.anchor, nextAnchor_);
      project(duration_s);
    }
  }

  const VectorArray& position() const { return position_; }

 private:
  Vec3f fixedPlace(const FleshAttachment::Fixed& f) const {
    return state_.skeleton.joint_world[f.joint.index()].point(f.position_joint).cast<float>();
  }

  void moveAnchors(float rate_per_s) {
    skin_.grid()->anchors().place(state_.flesh, scratch_, nextAnchor_);
    for (std::size_t k = 0; k < nextAnchor_.size(); ++k)
      put(around_.anchorVelocity, k, rate_per_s * (at(nextAnchor_, k) - at(around_.anchor, k)));
    for (const FleshAttachment::Fixed& f : skin_.grid()->fixed())
      put(velocity_, f.point, rate_per_s * (fixedPlace(f) - at(position_, f.point)));
  }

  void project(double duration_s) {
    for (const FleshAttachment::Fixed& f : skin_.grid()->fixed())
      put(position_, f.point, fixedPlace(f));
    const auto reach =
        static_cast<float>(2 * maxSpeed_m_per_s_ * duration_s + 0.01 * skin_.size_m());
    const auto restitution = static_cast<float>(skin_.contactResponse().restitution);
    maxSpeed_m_per_s_ = contact_
                            .project(state_.flesh, skin_.points(), reach, restitution, position_,
                                     velocity_, around_)
                            .maxSpeed_m_per_s;
    fillPads(skin_.grid()->layout(), position_);
  }

  const Character& character_;
  const Skin& skin_;
  int motion_;
  Scheme& scheme_;
  FleshContact contact_;
  VectorArray position_, velocity_, nextAnchor_, scratch_;
  PointSurroundings around_;
  CharacterState state_;  // the layers below the skin
  double maxSpeed_m_per_s_ = 0;
};

}  // namespace

Trajectory runLibrary(const Character& character, const SkinState& start,
                      const RunOptions& options) {
  CharacterState state;
  poseLayers(character, character.source(options.motion), true, state);
  state.skin.position = start.position;
  state.skin.velocity = start.velocity;
  Trajectory out;
  SkinStats stats;
  for (int f = 0; f < options.frames; ++f) {
    const double begin_s = now_s();
    advance(character, character.source(options.motion), kFrame_s, state, stats);
    out.cpu_s += now_s() - begin_s;
    out.frames.push_back(state.skin.position);
  }
  out.steps = static_cast<double>(stats.steps);
  return out;
}

Trajectory runScheme(const Character& character, const SkinState& start, const RunOptions& options,
                     Scheme& scheme, int stepsPerFrame) {
  SchemeRunner runner(character, start, options.motion, scheme);
  Trajectory out;
  for (int f = 0; f < options.frames; ++f) {
    const double begin_s = now_s();
    runner.frame(stepsPerFrame, out);
    out.cpu_s += now_s() - begin_s;
    out.frames.push_back(runner.position());
  }
  return out;
}

Difference difference(const GridLayout& g, const Trajectory& a, const Trajectory& b) {
  Difference out;
  double sum = 0;
  for (std::size_t f = 0; f < a.frames.size(); ++f) {
    for (int j = 0; j < g.rows; ++j) {
      for (int i = 0; i < g.columns; ++i) {
        const double squared =
            (at(a.frames[f], g.at(i, j)) - at(b.frames[f], g.at(i, j))).squaredNorm();
        sum += squared;
        out.max_m = std::max(out.max_m, std::sqrt(squared));
      }
    }
  }
  out.rms_m = std::sqrt(sum / static_cast<double>(a.frames.size() * g.pointCount()));
  return out;
}

}  // namespace fascia
