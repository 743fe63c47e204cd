#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>
#include <vector>

#include <fascia/io/documents/character_file.h>
#include <fascia/io/documents/scene_file.h>

namespace fascia::test {

inline std::vector<std::string> exampleCharacters() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(FASCIA_SOURCE_DIR "/examples"))
    if (const std::string path = entry.path().string();
        path.ends_with(".fascia.json") && !isSceneFile(path))
      files.push_back(path);
  std::sort(files.begin(), files.end());
  return files;
}

// Those whose skin is a grid, which follows edits.
inline std::vector<std::string> exampleGrids() {
  std::vector<std::string> files = exampleCharacters();
  std::erase_if(files, [](const std::string& file) {
    return readCharacterFile(file).def.skin->surface.has_value();
  });
  return files;
}

inline std::string exampleName(const testing::TestParamInfo<std::string>& file) {
  std::string name = std::filesystem::path(file.param).stem().stem().string();
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

// Short grids and long edges keep the tests quick; the models are the same.
inline Character loadExample(const std::string& path, int columns, int rows,
                             const std::string& integrator = "") {
  BuildOptions options;
  options.columns = columns, options.rows = rows;
  options.integrator = integrator;
  CharacterDef def = readCharacterFile(path).def;
  if (def.skin && def.skin->surface) {
    options.columns = options.rows = 0;
    *def.skin->surface->edge_m *= columns * rows < 400 ? 3 : 1.5;
  }
  return Character(def, options);
}

}  // namespace fascia::test
