#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <fascia/io/picture/texture.h>
#include <fascia/world/stage_recording.h>

namespace fascia {

// An *.fcache of a scene: a performance with everything needed to show it again, in one file. What
// it takes to perform again, the script, is not in it.
struct SceneCache {
  Stage stage;                    // with its characters and meshes
  std::vector<Texture> textures;  // of the characters' skins
  StageRecording recording;
};

// Exact: what is read has the same bits, but for the time that it took. Both throw Error.
void writeSceneCache(const Stage& stage, const StageRecording& recording, const std::string& path);
SceneCache parseSceneCache(std::string_view bytes, const std::string& file = {});
bool isSceneCache(std::string_view bytes);  // by its first bytes

}  // namespace fascia
