#include "example_files.h"

#include <filesystem>
#include <string_view>

#include <fascia/base/error.h>

namespace fascia {

namespace fs = std::filesystem;

std::string findExamples() {
  std::error_code unreadable;
  const fs::path here = fs::current_path(unreadable);
  const fs::path program = fs::read_symlink("/proc/self/exe", unreadable);
  for (const fs::path& start : {here, program.parent_path()})
    for (fs::path folder = start; !folder.empty(); folder = folder.parent_path()) {
      for (const char* place : {"examples", "share/fascia/examples"})
        if (fs::exists(folder / place / "penguin.fascia.json", unreadable))
          return (folder / place).string();
      if (folder == folder.parent_path()) break;
    }
  throw Error("the example characters were not found; name their folder with --examples");
}

std::function<std::string(const std::string&)> exampleFiles() {
  return [](const std::string& path) -> std::string {
    constexpr std::string_view kFolder = "examples/";
    std::error_code unreadable;
    if (!path.starts_with(kFolder) || fs::exists(path, unreadable)) return path;
    try {
      const std::string found = findExamples() + "/" + path.substr(kFolder.size());
      return fs::exists(found, unreadable) ? found : path;
    } catch (const Error&) {
      return path;
    }
  };
}

}  // namespace fascia
