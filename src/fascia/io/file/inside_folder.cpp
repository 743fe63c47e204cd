#include <fascia/io/file/inside_folder.h>

#include <algorithm>
#include <filesystem>

namespace fascia {

Error errorAt(const std::string& pointer, const std::string& message, const std::string& hint) {
  Issue issue;
  issue.where.pointer = pointer;
  issue.message = message;
  issue.hint = hint;
  return Error(std::move(issue));
}

std::string insideFolder(const std::string& folder, const std::string& name,
                         const std::string& subject, const std::string& pointer) {
  namespace fs = std::filesystem;
  const fs::path relative(name);
  const bool climbs = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (relative.empty() || relative.is_absolute() || climbs ||
      name.find('\\') != std::string::npos || name.find('\0') != std::string::npos) {
    throw errorAt(pointer, subject + " must be named by a path inside this file's folder",
                  "put the file beside this one and write its plain name");
  }
  std::error_code error;
  const fs::path root = fs::canonical(folder.empty() ? "." : folder, error);
  const fs::path place = error ? fs::path() : fs::canonical(root / relative, error);
  if (error)
    throw errorAt(pointer, subject + " is missing: " + (fs::path(folder) / relative).string());
  const auto [rootEnd, rest] = std::mismatch(root.begin(), root.end(), place.begin(), place.end());
  if (rootEnd != root.end())
    throw errorAt(pointer, subject + " is a link that leads out of this file's folder");
  return place.string();
}

}  // namespace fascia
