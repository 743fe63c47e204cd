#include "player.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include <fascia/render/character_scene.h>

namespace fascia {
namespace {

constexpr int kReachSamples =
    60;  // a swing's turning point is missed by less than 1 % of the swing

const Recording::Frame& frameAt(const Recording& recording, double time_s) {
  const std::vector<Recording::Frame>& frames = recording.frames;
  if (frames.empty()) throw Error("there are no frames to draw");
  const double halfFrame_s = 0.5 / recording.frame_rate_hz;
  if (time_s < frames.front().time_s - halfFrame_s || time_s > frames.back().time_s + halfFrame_s)
    throw Error(fmt::format("there is no frame at {} s: they go from {:g} s to {:g} s", time_s,
                            frames.front().time_s, frames.back().time_s));
  const auto closer = [time_s](const Recording::Frame& a, const Recording::Frame& b) {
    return std::abs(a.time_s - time_s) < std::abs(b.time_s - time_s);
  };
  return *std::min_element(frames.begin(), frames.end(), closer);
}

}  // namespace

Player::Player(const Character& character, const Recording& recording)
    : character_(character),
      recording_(recording),
      motion_(recording.motion.empty() ? -1 : character.findMotion(recording.motion)),
      skin_(recording.skin),
      normals_(recording.skin) {}

void Player::seek(double time_s) {
  const Recording::Frame& frame = frameAt(recording_, time_s);
  state_.time_s = frame.time_s;
  poseLayers(character_, motion_, false, state_);
  skin_.positions = frame.skin_m;
  normals_.compute(skin_.positions, skin_.normals);
}

Box motionReach(const Character& character, int motion) {
  const double duration_s =
      motion < 0 ? 0 : character.motion(static_cast<std::size_t>(motion)).duration_s;
  const Layers all{true, true, true};
  CharacterState state;
  Box box;
  for (int i = 0; i <= kReachSamples; ++i) {
    state.time_s = duration_s * i / kReachSamples;
    poseLayers(character, motion, false, state);
    box.add(visibleBounds(state, {}, all));
  }
  return box;
}

}  // namespace fascia
