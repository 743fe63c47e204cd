#include <unordered_map>

#include <fascia/rig/joint_words.h>

namespace fascia {
namespace {

const std::unordered_map<std::string_view, JointWord>& japaneseVocabulary() {
  static const std::unordered_map<std::string_view, JointWord> all = {
      {"下半身", JointWord::hips},     {"腰", JointWord::hips},
      {"上半身", JointWord::spine},    {"胸", JointWord::spine},
      {"上胸", JointWord::spine},      {"首", JointWord::neck},
      {"頭", JointWord::head},         {"肩", JointWord::clavicle},
      {"腕", JointWord::upperArm},     {"上腕", JointWord::upperArm},
      {"ひじ", JointWord::lowerArm},   {"肘", JointWord::lowerArm},
      {"前腕", JointWord::lowerArm},   {"手首", JointWord::hand},
      {"手", JointWord::hand},         {"足", JointWord::upperLeg},
      {"脚", JointWord::upperLeg},     {"もも", JointWord::upperLeg},
      {"太もも", JointWord::upperLeg}, {"ひざ", JointWord::lowerLeg},
      {"膝", JointWord::lowerLeg},     {"すね", JointWord::lowerLeg},
      {"足首", JointWord::foot},       {"つま先", JointWord::toe},
      {"爪先", JointWord::toe},        {"足先EX", JointWord::toe},
      {"親指", JointWord::thumb},      {"人指", JointWord::index},
      {"人差指", JointWord::index},    {"人差し指", JointWord::index},
      {"中指", JointWord::middle},     {"薬指", JointWord::ring},
      {"小指", JointWord::pinky}};
  return all;
}

bool takePrefix(std::string_view& name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return false;
  name.remove_prefix(prefix.size());
  return true;
}
bool takeSuffix(std::string_view& name, std::string_view suffix) {
  if (!name.ends_with(suffix)) return false;
  name.remove_suffix(suffix.size());
  return true;
}

// A digit at the end, of plain or of full width ("１" is EF BC 91).
bool takeDigit(std::string_view& name, std::string& number) {
  if (!name.empty() && name.back() >= '0' && name.back() <= '9') {
    number.insert(number.begin(), name.back());
    name.remove_suffix(1);
    return true;
  }
  constexpr std::string_view kWide = "\xEF\xBC";
  if (name.size() < 3 || name.substr(name.size() - 3, 2) != kWide) return false;
  const auto last = static_cast<unsigned char>(name.back());
  if (last < 0x90 || last > 0x99) return false;
  number.insert(number.begin(), static_cast<char>('0' + last - 0x90));
  name.remove_suffix(3);
  return true;
}

BodySide takeJapaneseSide(std::string_view& name) {
  for (const std::string_view left : {".L", "_L", "左"})
    if (takeSuffix(name, left)) return BodySide::left;
  for (const std::string_view right : {".R", "_R", "右"})
    if (takeSuffix(name, right)) return BodySide::right;
  if (takePrefix(name, "左")) return BodySide::left;
  return takePrefix(name, "右") ? BodySide::right : BodySide::middle;
}

}  // namespace

JointReading readJapaneseJointName(std::string_view name) {
  JointReading reading;
  reading.side = takeJapaneseSide(name);
  while (takeDigit(name, reading.number)) {
  }
  // Legs that copy the legs' turns and carry the mesh ("左足D").
  const auto& all = japaneseVocabulary();
  auto found = all.find(name);
  if (found == all.end() && takeSuffix(name, "D")) found = all.find(name);
  if (found == all.end()) return {};
  reading.word = found->second;
  reading.known = true;
  return reading;
}

}  // namespace fascia
