#pragma once

#include <memory>
#include <string>
#include <vector>

#include <fascia/facade/rig_pictures.h>
#include <fascia/render/player.h>
#include <fascia/render/stage_scene.h>
#include <fascia/world/stage_recording.h>

namespace fascia {

// Shows a performance again, without simulating. All that it is given must outlive it.
class StagePlayer {
 public:
  // textures: of the characters' skins. Notes pictures that cannot be read.
  StagePlayer(const Stage& stage, const StageRecording& recording,
              const std::vector<Texture>& textures, std::vector<std::string>* notes = nullptr);

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
