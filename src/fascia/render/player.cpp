#include <fascia/render/player.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/suggest.h>
#include <fascia/render/character_scene.h>

namespace fascia {
namespace {

constexpr int kReachSamples =
    60;  // a swing's turning point is missed by less than 1 % of the swing

constexpr double kOffTheFloor = 0.04;  // of the height: feet farther from 0 have a floor elsewhere

// A recorded frame, standing still.
class FramePosture final : public PostureSource {
 public:
  FramePosture(const Recording::Frame& frame, const ClipSource& motion)
      : frame_(frame), motion_(motion) {}
  void sample(double, PostureSample& out) const override {
    motion_.sample(frame_.time_s, out);
    out.posture.values = frame_.posture;
    out.posture.rates.assign(out.posture.values.size(), 0.0);
    if (!frame_.parameters.empty()) out.parameters = frame_.parameters;
    if (frame_.morphs.empty()) return;
    out.morphs.weights = frame_.morphs;
    std::ranges::fill(out.morphs.rates, 0.0);
  }

 private:
  const Recording::Frame& frame_;
  const ClipSource& motion_;
};

}  // namespace

std::size_t closestFrame(std::span<const double> times_s, double frameRate_hz, double time_s) {
  if (times_s.empty()) throw Error("there are no frames to draw");
  const double halfFrame_s = 0.5 / frameRate_hz;
  if (time_s < times_s.front() - halfFrame_s || time_s > times_s.back() + halfFrame_s)
    throw Error("there is no frame at " + shortNumber(time_s) + " s: they go from " +
                shortNumber(times_s.front()) + " s to " + shortNumber(times_s.back()) + " s");
  const auto closest = std::ranges::min_element(
      times_s, {}, [time_s](double frame_s) { return std::abs(frame_s - time_s); });
  return static_cast<std::size_t>(closest - times_s.begin());
}

Player::Player(const Character& character, const Recording& recording)
    : character_(character),
      recording_(recording),
      motion_(
          character.source(recording.motion.empty() ? -1 : character.findMotion(recording.motion))),
      skin_(recording.skin),
      normals_(recording.skin) {
  for (const Recording::Frame& frame : recording.frames) times_s_.push_back(frame.time_s);
  if (!hasRig(character)) return;
  creases_.emplace(*character.def().rig->model);
  blended_.emplace(character);
}

void Player::seek(double time_s) {
  const Recording::Frame& frame =
      recording_.frames[closestFrame(times_s_, recording_.frame_rate_hz, time_s)];
  state_.time_s = frame.time_s;
  if (const auto& soft = character_.softFlesh(); soft && !frame.soft_shapes.empty()) {
    if (frame.soft_shapes.size() != soft->shapeSize())
      throw Error("the recording's soft solids are not those of the character");
    soft->setShapes(frame.soft_shapes, frame.time_s, state_.bodies);
  }
  poseLayers(character_, FramePosture(frame, motion_), false, state_);
  skin_.positions = frame.skin_m;
  if (creases_) {
    if (frame.skin_m.empty()) blended_->compute(state_, skin_.positions);
    creases_->compute(skin_.positions, skin_.normals);
    return;
  }
  normals_.compute(skin_.positions, skin_.normals);
}

Reach motionReach(const Character& character, const PostureSource& source) {
  const double duration_s = source.info().duration_s;
  std::optional<BlendedSkin> blended;
  if (hasRig(character)) blended.emplace(character);
  CharacterState state;
  std::vector<Eigen::Vector3f> surface;
  Reach reach;
  for (int i = 0; i <= kReachSamples; ++i) {
    state.time_s = duration_s * i / kReachSamples;
    poseLayers(character, source, false, state);
    if (blended) {
      blended->compute(state, surface);
      for (const Eigen::Vector3f& p : surface) reach.add(p.cast<double>());
    } else {
      reach.add(visibleBounds(state, {}, {true, true, true}));
    }
  }
  return reach;
}

double floorHeight(const Character& character, const Reach& reach) {
  if (!hasRig(character) || reach.empty()) return 0;
  const double lowest_m = reach.box().low.y();
  Box rest;
  for (const Eigen::Vector3f& p : character.def().rig->model->points_m) rest.add(p.cast<double>());
  if (rest.empty()) return 0;
  const double tolerance_m = kOffTheFloor * rest.size().maxCoeff();
  const double feet_m = std::abs(rest.low.y()) < tolerance_m ? 0 : rest.low.y();
  return lowest_m < feet_m - tolerance_m ? lowest_m : feet_m;
}

}  // namespace fascia
