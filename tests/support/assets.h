#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace fascia {

// A file of the shared assets: in FASCIA_ASSETS, or beside the project. None: the test is skipped.
inline std::optional<std::filesystem::path> assetFile(const std::string& name) {
  const char* given = std::getenv("FASCIA_ASSETS");
  const std::filesystem::path folder =
      given ? std::filesystem::path(given)
            : std::filesystem::path(FASCIA_SOURCE_DIR) / "../shared/assets";
  const std::filesystem::path file = folder / name;
  if (!std::filesystem::exists(file)) return std::nullopt;
  return file;
}

// A file that once was read wrongly, kept beside the assets. None: the test is skipped.
inline std::optional<std::filesystem::path> caseFile(const std::string& name) {
  return assetFile("../cases/" + name);
}

}  // namespace fascia
