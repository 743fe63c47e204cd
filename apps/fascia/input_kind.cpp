#include "input_kind.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <fascia/base/suggest.h>
#include <fascia/io/cache/cache.h>
#include <fascia/io/file/file.h>
#include <fascia/io/json/json.h>

#include "outputs.h"
#include "shell_word.h"

namespace fascia {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHead = 4096;  // enough to know a format by
constexpr std::size_t kMostNamed = 3;

std::string headOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string head(kHead, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  return head;
}

struct Sign {
  const char* text;
  InputKind kind;
};

InputKind kindByHead(std::string_view head) {
  if (isCache(head)) return InputKind::recording;
  static constexpr std::array<Sign, 8> kFirst{{{"glTF", InputKind::model},
                                               {"Kaydara FBX", InputKind::model},
                                               {"; FBX", InputKind::model},
                                               {"HIERARCHY", InputKind::motion},
                                               {"POINTCACHE2", InputKind::pointCache},
                                               {"\x89PNG", InputKind::picture},
                                               {"\xff\xd8\xff", InputKind::picture},
                                               {"GIF8", InputKind::picture}}};
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  for (const Sign& sign : kFirst)
    if (head.starts_with(sign.text) ||
        (start != std::string_view::npos && head.substr(start).starts_with(sign.text)))
      return sign.kind;
  if (head.substr(0, 12).ends_with("ftyp") || head.substr(4).starts_with("ftyp"))
    return InputKind::video;
  if (head.find("<COLLADA") != std::string_view::npos) return InputKind::model;
  return InputKind::unknown;
}

InputKind kindByEnding(const std::string& path) {
  struct Known {
    InputKind kind;
    std::vector<std::string> endings;
  };
  static const std::vector<Known> kKnown = {
      {InputKind::model,
       {".glb", ".gltf", ".vrm", ".vrma", ".fbx", ".dae", ".obj", ".blend", ".x", ".ms3d", ".smd",
        ".ply", ".stl", ".3ds", ".usd", ".usdz", ".mhskel"}},
      {InputKind::motion, {".bvh"}},
      {InputKind::recording, {".fcache"}},
      {InputKind::pointCache, {".pc2", ".mdd"}},
      {InputKind::picture, {".png", ".jpg", ".jpeg", ".gif", ".tga", ".bmp", ".webp"}},
      {InputKind::video, {".mp4", ".webm", ".mov", ".avi"}},
      {InputKind::script, {".lua"}},
  };
  std::string name = path;
  if (endingOf(name) == ".gz") name.resize(name.size() - 3);
  const std::string ending = endingOf(name);
  for (const Known& known : kKnown)
    if (std::find(known.endings.begin(), known.endings.end(), ending) != known.endings.end())
      return known.kind;
  return InputKind::unknown;
}

// A JSON text is a glTF, or a file of ours; anything else has no kind.
InputKind kindOfJson(const std::string& path) {
  std::vector<Issue> issues;
  const Json root = parseJson(readFile(path, JsonLimits{}.bytes), JsonLimits{}, issues);
  if (!issues.empty() || !root.is(Json::Kind::object)) return InputKind::unknown;
  if (root.find("asset") && !root.find("fascia")) return InputKind::model;
  if (!root.find("fascia")) return InputKind::unknown;
  const Json* kind = root.find("kind");
  const bool scene = kind && kind->is(Json::Kind::text) && kind->text() == "scene";
  return scene ? InputKind::scene : InputKind::character;
}

std::string described(InputKind kind) {
  switch (kind) {
    case InputKind::character:
      return "is a character";
    case InputKind::scene:
      return "is a scene";
    case InputKind::recording:
      return "is a recording of a motion that was simulated";
    case InputKind::model:
      return "is a 3D model";
    case InputKind::motion:
      return "is a motion capture file";
    case InputKind::pointCache:
      return "is a point cache";
    case InputKind::picture:
      return "is a picture";
    case InputKind::video:
      return "is a video";
    case InputKind::script:
      return "is a script";
    case InputKind::folder:
      return "is a folder";
    case InputKind::empty:
      return "is empty";
    case InputKind::unknown:
      break;
  }
  return {};
}

std::string expected(const Wanted& wanted) {
  std::vector<std::string> kinds;
  if (wanted.character) kinds.emplace_back("a character");
  if (wanted.scene) kinds.emplace_back("a scene");
  if (wanted.recording) kinds.emplace_back("a recording (.fcache)");
  if (wanted.model) kinds.emplace_back("a rigged model (.glb, .fbx, …)");
  std::string text;
  for (std::size_t i = 0; i < kinds.size(); ++i)
    text += (i == 0 ? "" : i + 1 == kinds.size() ? " or " : ", ") + kinds[i];
  return text;
}

bool takes(const Wanted& wanted, InputKind kind) {
  switch (kind) {
    case InputKind::character:
      return wanted.character;
    case InputKind::scene:
      return wanted.scene;
    case InputKind::recording:
      return wanted.recording;
    case InputKind::model:
      return wanted.model;
    case InputKind::unknown:
      return true;
    default:
      return false;
  }
}

std::string stemOf(const std::string& path) {
  std::string name = fs::path(path).filename().string();
  return name.substr(0, name.find('.'));
}

std::string outputOf(const std::string& command, const std::string& stem) {
  if (command == "bake") return " -o " + shellWord(stem + "_alive.glb");
  if (command == "render" || command == "compare") return " -o " + shellWord(stem + ".mp4");
  return "";
}

// The characters and scenes of a folder, to choose from.
std::string filesIn(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreadable))
    if (entry.path().string().ends_with(".fascia.json")) names.push_back(entry.path().string());
  std::sort(names.begin(), names.end());
  if (names.empty()) return "name a file in it";
  const std::size_t shown = std::min(names.size(), kMostNamed);
  return fmt::format("name a file in it: {}{}",
                     fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "),
                     names.size() > shown ? ", …" : "");
}

std::string hintFor(const std::string& path, InputKind kind, const Wanted& wanted) {
  const std::string file = shellWord(path), stem = stemOf(path);
  const std::string character = shellWord(stem + ".fascia.json");
  switch (kind) {
    case InputKind::model:
      if (!wanted.character) return "characters and scenes are *.fascia.json files";
      return fmt::format(
          "if it is rigged, make a character of it first: fascia flesh {} -o {}; then: fascia {} "
          "{}{}",
          file, character, wanted.command, character, outputOf(wanted.command, stem));
    case InputKind::motion:
      return fmt::format(
          "put it onto a character with a rig: fascia {} CHARACTER.fascia.json --motion {}{}",
          wanted.command == "info" || wanted.command == "render" ? wanted.command : "bake", file,
          wanted.command == "info"
              ? std::string()
              : outputOf(wanted.command == "render" ? "render" : "bake", stem));
    case InputKind::recording:
      return fmt::format(
          "'fascia render {} -o {}' draws it; here belongs the *.fascia.json that it "
          "was made from",
          file, shellWord(stem + ".mp4"));
    case InputKind::character:
      if (wanted.model && !wanted.scene)
        return fmt::format("it has its flesh; go on with: fascia bake {} -o {}", file,
                           shellWord(stem + ".glb"));
      return "a scene says \"kind\": \"scene\" and names its characters; see docs/scenes.md";
    case InputKind::scene:
      return fmt::format("draw it with: fascia render {} -o {}", file, shellWord(stem + ".mp4"));
    case InputKind::folder:
      return filesIn(path);
    case InputKind::script:
      return "a scene names its script; give the scene";
    case InputKind::empty:
      return "was it written to the end?";
    default:
      return "characters and scenes are *.fascia.json files; rigged models become characters by "
             "'fascia flesh'";
  }
}

// Faults that name no file are of what this one leads to.
std::vector<Issue> named(std::vector<Issue> issues, const std::string& path) {
  for (Issue& issue : issues)
    if (issue.where.file.empty()) issue.where.file = path;
  return issues;
}

}  // namespace

InputKind kindOfInput(const std::string& path) {
  std::error_code fault;
  if (fs::is_directory(path, fault)) return InputKind::folder;
  if (!fs::is_regular_file(path, fault)) return InputKind::unknown;
  if (fs::file_size(path, fault) == 0) return InputKind::empty;
  const std::string head = headOf(path);
  const InputKind kind = kindByHead(head);
  if (kind != InputKind::unknown) return kind;
  const std::size_t start = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (start != std::string::npos && head[start] == '{') {
    try {
      return kindOfJson(path);
    } catch (const Error&) {
      return InputKind::unknown;  // too large, or gone: whoever reads it says so
    }
  }
  return kindByEnding(path);
}

void withInput(const std::string& path, const Wanted& wanted, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::bad_alloc&) {
    throw fileError(path, "needs more memory than there is");
  } catch (const std::length_error&) {
    throw fileError(path, "needs more memory than there is");
  } catch (const Error& error) {
    const InputKind kind = kindOfInput(path);
    if (takes(wanted, kind)) throw Error(named(error.issues(), path));
    throw fileError(path, fmt::format("{}, expected {}", described(kind), expected(wanted)),
                    hintFor(path, kind, wanted));
  }
}

void refuseMotionFile(const std::string& motion) {
  const InputKind kind = kindByEnding(motion);
  const bool motionOnly = endingOf(motion) == ".amc";
  if (kind == InputKind::unknown && !motionOnly) return;
  Issue issue;
  issue.message = "the motion " + quotedName(motion) +
                  " looks like a file, and motions are read from .bvh, .glb, .vrma and .fbx";
  issue.hint = "export it as .bvh, or give the name of one of the character's own motions";
  throw Error(std::move(issue));
}

}  // namespace fascia
