#include "outputs.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include <fascia/base/hash.h>
#include <fascia/io/documents/stats_writer.h>
#include <fascia/io/file/inputs.h>
#include <fascia/io/file/temporary_file.h>

namespace fascia {

namespace fs = std::filesystem;

std::string endingOf(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

bool isGlb(const std::string& path) {
  return endingOf(path) == ".glb" || endingOf(path) == ".vrm";
}

std::function<std::string(const std::string&)> endsIn(const std::vector<std::string>& endings) {
  return [endings](const std::string& path) -> std::string {
    if (std::find(endings.begin(), endings.end(), endingOf(path)) != endings.end()) return {};
    return fmt::format("cannot tell the format of '{}': expected a name that ends in {}", path,
                       fmt::join(endings, ", "));
  };
}

void checkFolders(const std::vector<std::string>& paths) {
  std::vector<Issue> issues;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    const fs::path folder = fs::path(endOfLinks(path)).parent_path();
    const std::string shown = folder.empty() ? "." : folder.string();
    std::error_code unreadable;
    if (fs::is_directory(path, unreadable))
      issues.push_back({{path, 0, {}}, "is a folder", "name a file"});
    else if (!fs::is_directory(shown, unreadable))
      issues.push_back({{path, 0, {}}, "there is no folder '" + shown + "'", "make it first"});
    else if (access(shown.c_str(), W_OK) != 0)
      issues.push_back({{path, 0, {}}, "the folder '" + shown + "' cannot be written to", {}});
  }
  if (!issues.empty()) throw Error(std::move(issues));
}

void checkOverwriting(const std::vector<std::string>& outputs, const std::string& stats) {
  std::vector<std::string> files{stats};
  files.insert(files.end(), outputs.begin(), outputs.end());
  std::erase(files, std::string());
  std::vector<fs::path> taken;
  for (const std::string& file : files) {
    const fs::path place = fs::weakly_canonical(fs::absolute(endOfLinks(file)));
    if (std::find(taken.begin(), taken.end(), place) != taken.end())
      throw fileError(file, "would be written twice", "choose another name");
    taken.push_back(place);
  }
  planOutputs(files);
}

namespace {

Json withStats(Json answer, const Recording& recording) {
  std::vector<Issue> issues;
  answer.set("stats", parseJson(statsJson(recording), JsonLimits{}, issues));
  return answer;
}

Json answerOf(const std::vector<std::string>& outputs) {
  Json::List written;
  for (const std::string& path : outputs) written.push_back(path);
  return Json::Object{{"ok", true}, {"outputs", written}};
}

std::string sizeOf(const Recording& r) {
  return fmt::format("{} frames, {} vertices", r.frames.size(), r.skin.positions.size());
}

std::string simulatedIn(const Recording& r) {
  const double ratio = r.wall_s > 0 ? r.simulated_s / r.wall_s : 0;
  return fmt::format("{}: simulated {:.4g} s in {:.2g} s ({:.0f} × real time)", sizeOf(r),
                     r.simulated_s, r.wall_s, ratio);
}

}  // namespace

void reportRecordings(std::span<const Recording* const> recordings,
                      const std::vector<std::string>& outputs, const Console& console,
                      const Json::Object& more) {
  const bool several = recordings.size() > 1;
  Json::List motions;
  Json answer = answerOf(outputs);
  for (const Recording* r : recordings) {
    console.say((several ? r->motion + ": " : std::string()) + simulatedIn(*r));
    if (several)
      motions.push_back(withStats(Json::Object{{"motion", r->motion}}, *r));
    else
      answer = withStats(std::move(answer), *r);
  }
  if (several) answer.set("motions", std::move(motions));
  for (const Json::Member& member : more) answer.set(member.key, member.value);
  console.answer(answer);
}

void reportRecording(const Recording& recording, const std::vector<std::string>& outputs,
                     const Console& console, const std::string& cache) {
  if (cache.empty())
    console.say(simulatedIn(recording));
  else
    console.say(sizeOf(recording) + ": read from cache " + cache);
  console.answer(withStats(answerOf(outputs), recording));
}

}  // namespace fascia
