#include "source_rules.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

namespace fs = std::filesystem;

namespace {

std::vector<std::string> readLines(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::string withoutCommentAndText(const std::string& line) {
  static const std::regex text(R"("([^"\\]|\\.)*")");
  const std::string bare = std::regex_replace(line, text, "\"\"");
  return bare.substr(0, bare.find("//"));
}

// A thing that only one module may do; the programs in apps/ are not looked at.
struct Rule {
  std::regex pattern;
  std::string owner;  // empty: no module may
  std::string what;
};

const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = {
      {std::regex(
           R"(#include\s*<(fstream|filesystem|fcntl\.h)>|\b(fopen|freopen|ifstream|ofstream)\b)"),
       "io", "handles files"},
      {std::regex(R"(#include\s*[<"](epoxy|GL|GLES\d?|EGL|GLFW|SDL2?|X11|Q[A-Z]\w*)\b)"), "render",
       "knows a window or OpenGL"},
      {std::regex(
           R"(#include\s*<(iostream|spdlog/|print>)|\b(v?f?printf|f?puts|putchar)\s*\(|\bstd::(cout|cerr|clog)\b|\bfmt::print\b)"),
       "", "prints"},
  };
  return all;
}

// "io" of io/json/json.h; a header in no folder, fascia.h, is the outermost module's.
std::string moduleOf(const fs::path& file) {
  return file.has_parent_path() ? file.begin()->string() : "facade";
}

// "io/json" of io/json/json.h
std::string folderOf(const fs::path& file) {
  return file.parent_path().generic_string();
}

class Checker {
 public:
  explicit Checker(const Arrows& arrows) : arrows_(arrows) {}

  void check(const fs::path& shown, const fs::path& file) {
    const std::string module = moduleOf(shown);
    if (hasFolders(module) && folderOf(shown) != module && !arrows_.contains(folderOf(shown)))
      complainOfMissing(shown, "folder " + folderOf(shown));
    const std::vector<std::string> lines = readLines(file);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string place = shown.generic_string() + ":" + std::to_string(i + 1) + ": ";
      checkArrow(shown, place, lines[i]);
      const std::string code = withoutCommentAndText(lines[i]);
      for (const Rule& rule : rules())
        if (module != rule.owner && std::regex_search(code, rule.pattern))
          violations.push_back(place + rule.what);
    }
  }

  void complainOfMissing(const fs::path& shown, const std::string& what) {
    violations.push_back(shown.generic_string() + ": " + what + " is missing in ARCHITECTURE.md");
  }

  std::vector<std::string> violations;

 private:
  bool hasFolders(const std::string& module) const {
    const auto next = arrows_.upper_bound(module + "/");
    return next != arrows_.end() && next->first.starts_with(module + "/");
  }

  void checkArrow(const fs::path& from, const std::string& place, const std::string& line) {
    static const std::regex include(R"(^\s*#\s*include\s*[<"](fascia/([\w/]+\.h)))");
    std::smatch match;
    if (!std::regex_search(line, match, include)) return;
    const fs::path to = match[2].str();
    const std::string module = moduleOf(from);
    if (!arrows_.at(module).contains(moduleOf(to))) complain(place, match[1], module, moduleOf(to));
    // The files of a module that are in no folder may use all of its folders.
    const std::string folder = folderOf(from);
    if (module != moduleOf(to) || folder == module || !arrows_.contains(folder)) return;
    if (!arrows_.at(folder).contains(folderOf(to))) complain(place, match[1], folder, folderOf(to));
  }

  void complain(const std::string& place, const std::string& include, const std::string& from,
                const std::string& to) {
    violations.push_back(place + "includes <" + include + ">, but " + from + " may not use " + to);
  }

  const Arrows& arrows_;
};

}  // namespace

Arrows readArrows(const fs::path& architecture) {
  static const std::regex row(R"(^\| ([\w/]+) \|[^|]*\| ([\w/, –]+) \|$)");
  static const std::regex name(R"([\w/]+)");
  Arrows arrows;
  for (const std::string& line : readLines(architecture)) {
    std::smatch match;
    if (!std::regex_match(line, match, row) || match[1] == "module" || match[1] == "folder")
      continue;
    std::set<std::string> allowed{match[1].str()};
    const std::string uses = match[2].str();
    for (std::sregex_iterator it(uses.begin(), uses.end(), name), end; it != end; ++it)
      if (const auto found = arrows.find(it->str()); found != arrows.end())
        allowed.insert(found->second.begin(), found->second.end());
    arrows[match[1].str()] = allowed;
  }
  return arrows;
}

std::vector<std::string> findViolations(const fs::path& root, const Arrows& arrows) {
  Checker checker(arrows);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".cpp") continue;
    const fs::path shown = fs::relative(entry.path(), root);
    if (arrows.contains(moduleOf(shown)))
      checker.check(shown, entry.path());
    else
      checker.complainOfMissing(shown, "module " + moduleOf(shown));
  }
  std::sort(checker.violations.begin(), checker.violations.end());
  return checker.violations;
}
