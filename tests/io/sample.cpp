#include "sample.h"

#include <filesystem>

#include <stdlib.h>

namespace fascia::sample {
namespace fs = std::filesystem;

Folder::Folder() {
  std::string name = (fs::temp_directory_path() / "fascia-io-XXXXXX").string();
  if (!mkdtemp(name.data())) throw Error("no temporary folder");
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::size_t Folder::entryCount() const {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
}

std::vector<Issue> faults(const std::string& text) {
  try {
    readCharacterText(text, "x.fascia.json");
  } catch (const Error& error) {
    return error.issues();
  }
  return {};
}

}  // namespace fascia::sample
