#pragma once

#include <memory>
#include <vector>

#include <fascia/io/picture/texture.h>
#include <fascia/render/stage_scene.h>
#include <fascia/world/stage_recording.h>

#include "console.h"
#include "player.h"

namespace fascia {

// Shows a performance again, without simulating. All that it is given must outlive it.
class StagePlayer {
 public:
  // textures: of the characters' skins.
  StagePlayer(const Stage& stage, const StageRecording& recording,
              const std::vector<Texture>& textures, const Console& console);

  // Goes to the frame closest to a time. Throws Error if the time lies outside of the recording.
  void seek(double time_s);

  // What there is to see now; valid until the next seek().
  const StageMoment& moment() const { return moment_; }

 private:
  const StageRecording& recording_;
  std::vector<double> times_s_;                   // of the frames
  std::vector<std::unique_ptr<Player>> players_;  // of the characters
  StageMoment moment_;
};

}  // namespace fascia
