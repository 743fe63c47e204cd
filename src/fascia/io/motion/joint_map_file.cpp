#include <fascia/io/motion/joint_map_file.h>

#include <fascia/base/error.h>
#include <fascia/io/file/file.h>
#include <fascia/io/json/json.h>

namespace fascia {
namespace {

constexpr std::size_t kMaxJointMapBytes = std::size_t{4} << 20;

JointMap fromJson(std::string_view text, const std::string& file) {
  std::vector<Issue> issues;
  const Json json = parseJson(text, JsonLimits{}, issues);
  JointMap map;
  if (issues.empty()) {
    for (const Json::Member& member : json.object()) {
      if (!member.value.is(Json::Kind::text) && !member.value.is(Json::Kind::null)) {
        Issue issue;
        issue.where.line = member.value.line();
        issue.where.pointer.append("/").append(escapedPointerKey(member.key));
        issue.message = "expected the name of a joint, or null";
        issues.push_back(std::move(issue));
        continue;
      }
      JointPair& pair = map.emplace_back();
      pair.source = member.key;
      if (member.value.is(Json::Kind::text)) pair.target = member.value.text();
      pair.why = "given";
      pair.line = member.value.line();
    }
  }
  for (Issue& issue : issues) issue.where.file = file;
  if (!issues.empty()) throw Error(std::move(issues));
  return map;
}

}  // namespace

JointMap jointMapOf(std::string_view text, const std::string& file) {
  text = withoutByteOrderMark(text);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool isJson = first != std::string_view::npos && text[first] == '{';
  return isJson ? fromJson(text, file) : parseJointMap(text, file);
}

JointMap readJointMap(const std::string& path) {
  return jointMapOf(readFile(path, kMaxJointMapBytes), path);
}

}  // namespace fascia
