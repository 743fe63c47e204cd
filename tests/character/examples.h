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

inline std::string exampleName(const testing::TestParamInfo<std::string>& file) {
  std::string name = std::filesystem::path(file.param).stem().stem().string();
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

// Short grids keep the tests quick; the models are the same.
inline Character loadExample(const std::string& path, int columns, int rows,
                             const std::string& integrator = "") {
  BuildOptions options;
  options.columns = columns, options.rows = rows;
  options.integrator = integrator;
  return loadCharacter(path, options);
}

}  // namespace fascia::test
