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

class Checker {
 public:
  explicit Checker(const Arrows& arrows) : arrows_(arrows) {}

  void check(const std::string& module, const fs::path& shown, const fs::path& file) {
    const std::vector<std::string> lines = readLines(file);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string place = shown.generic_string() + ":" + std::to_string(i + 1) + ": ";
      checkArrow(module, place, lines[i]);
      const std::string code = withoutCommentAndText(lines[i]);
      for (const Rule& rule : rules())
        if (module != rule.owner && std::regex_search(code, rule.pattern))
          violations.push_back(place + rule.what);
    }
  }

  std::vector<std::string> violations;

 private:
  void checkArrow(const std::string& module, const std::string& place, const std::string& line) {
    static const std::regex include(R"(^\s*#\s*include\s*[<"](fascia/(\w+)/[^>"]+))");
    std::smatch match;
    if (std::regex_search(line, match, include) && !arrows_.at(module).contains(match[2].str()))
      violations.push_back(place + "includes <" + match[1].str() + ">, but " + module +
                           " may not use " + match[2].str());
  }

  const Arrows& arrows_;
};

}  // namespace

Arrows readArrows(const fs::path& architecture) {
  static const std::regex row(R"(^\| (\w+) \|[^|]*\| ([\w, –]+) \|$)");
  static const std::regex name(R"(\w+)");
  Arrows arrows;
  for (const std::string& line : readLines(architecture)) {
    std::smatch match;
    if (!std::regex_match(line, match, row) || match[1] == "module") continue;
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
    const std::string module = shown.begin()->string();
    if (arrows.contains(module))
      checker.check(module, shown, entry.path());
    else
      checker.violations.push_back(shown.generic_string() + ": module " + module +
                                   " is missing in ARCHITECTURE.md");
  }
  std::sort(checker.violations.begin(), checker.violations.end());
  return checker.violations;
}
