#pragma once

#include <string>
#include <string_view>

#include <fascia/io/json/line_index.h>
#include <fascia/world/stage.h>

namespace fascia {

// A scene file as read: the definition, and where its parts stand.
struct SceneFile {
  SceneDef def;
  LineIndex lines;  // gives faults that building finds a file and a line
};

// Reads a *.fascia.json of kind "scene" with the characters (built with `options`), meshes and the
// script that it names; nothing outside of its folder. Throws Error with every fault at once: file,
// line, JSON pointer.
SceneFile readSceneFile(const std::string& path, const BuildOptions& options = {});
// The same from memory; `file` is what messages call it. Nothing else is read.
SceneFile readSceneText(std::string_view text, const std::string& file = {});

// Reads and builds: faults of both kinds carry file and line.
Stage loadStage(const std::string& path, const BuildOptions& options = {});

// The file's text; what equals its default is left out. Throws Error if the definition holds NaN or
// infinities.
std::string sceneText(const SceneDef& def);
void writeSceneFile(const SceneDef& def, const std::string& path);

// The published JSON Schema (draft-07).
std::string sceneSchema();

// Whether the file says that it is a scene; throws Error if it cannot be read.
bool isSceneFile(const std::string& path);

}  // namespace fascia
