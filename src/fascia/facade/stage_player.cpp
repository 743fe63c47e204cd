#include <fascia/facade/stage_player.h>

namespace fascia {

StagePlayer::StagePlayer(const Stage& stage, const StageRecording& recording,
                         const std::vector<Texture>& textures, std::vector<std::string>* notes)
    : recording_(recording) {
  for (const StageRecording::Frame& frame : recording.frames) times_s_.push_back(frame.time_s);
  for (std::size_t i = 0; i < recording.characters.size(); ++i) {
    const SceneCharacterDef& actor = stage.def().characters[i];
    const Character& character = *actor.character;
    players_.push_back(std::make_unique<Player>(character, recording.characters[i]));
    moment_.actors.push_back({&players_.back()->state(), &players_.back()->skin(),
                              toPixels(textures[i], actor.file), rigSurface(character, notes)});
  }
}

void StagePlayer::seek(double time_s) {
  const std::size_t frame = closestFrame(times_s_, recording_.frame_rate_hz, time_s);
  moment_.bodies = recording_.frames[frame].bodies;
  for (const auto& player : players_) player->seek(time_s);
}

}  // namespace fascia
