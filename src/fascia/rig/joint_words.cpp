#include <fascia/rig/joint_words.h>

#include <algorithm>
#include <cctype>
#include <unordered_map>
#include <vector>

namespace fascia {
namespace {

using Words = std::vector<std::string>;

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}
bool isUpper(char c) {
  return c >= 'A' && c <= 'Z';
}
bool isLetter(char c) {
  return isUpper(c) || (c >= 'a' && c <= 'z');
}

// "J_Bip_L_UpperArm01" -> j, bip, l, upper, arm, 01. Splits at signs, digits and capitals.
Words wordsOf(std::string_view name) {
  const std::size_t space = name.find_last_of(":|");
  if (space != std::string_view::npos) name.remove_prefix(space + 1);
  Words words;
  char last = ' ';
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (isLetter(c) || isDigit(c)) {
      const bool nextIsSmall =
          i + 1 < name.size() && isLetter(name[i + 1]) && !isUpper(name[i + 1]);
      const bool starts = isDigit(c) != isDigit(last) || !(isLetter(last) || isDigit(last)) ||
                          (isUpper(c) && (!isUpper(last) || nextIsSmall));
      if (starts) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    last = c;
  }
  return words;
}

const std::unordered_map<std::string_view, JointWord>& vocabulary() {
  static const std::unordered_map<std::string_view, JointWord> all = {
      {"hips", JointWord::hips},
      {"humanoidroot", JointWord::hips},
      {"hip", JointWord::hip},
      {"pelvis", JointWord::pelvis},
      {"hipjoint", JointWord::hipJoint},
      {"spine", JointWord::spine},
      {"chest", JointWord::spine},
      {"upperchest", JointWord::spine},
      {"chestlower", JointWord::spine},
      {"chestupper", JointWord::spine},
      {"abdomen", JointWord::spine},
      {"abdomenlower", JointWord::spine},
      {"abdomenupper", JointWord::spine},
      {"lowerback", JointWord::spine},
      {"back", JointWord::spine},
      {"torso", JointWord::spine},
      {"waist", JointWord::spine},
      {"upperbody", JointWord::spine},
      {"lowerbody", JointWord::hips},
      {"ribcage", JointWord::spine},
      {"neck", JointWord::neck},
      {"necklower", JointWord::neck},
      {"neckupper", JointWord::neck},
      {"head", JointWord::head},
      {"skullbase", JointWord::head},
      {"shoulder", JointWord::shoulder},
      {"clavicle", JointWord::clavicle},
      {"collar", JointWord::clavicle},
      {"sternoclavicular", JointWord::clavicle},
      {"arm", JointWord::arm},
      {"upperarm", JointWord::upperArm},
      {"uparm", JointWord::upperArm},
      {"shldr", JointWord::upperArm},
      {"shldrbend", JointWord::upperArm},
      {"humerus", JointWord::upperArm},
      {"forearm", JointWord::lowerArm},
      {"lowerarm", JointWord::lowerArm},
      {"elbow", JointWord::lowerArm},
      {"forearmbend", JointWord::lowerArm},
      {"radius", JointWord::lowerArm},
      {"hand", JointWord::hand},
      {"wrist", JointWord::hand},
      {"leg", JointWord::leg},
      {"upleg", JointWord::upperLeg},
      {"upperleg", JointWord::upperLeg},
      {"thigh", JointWord::upperLeg},
      {"thighbend", JointWord::upperLeg},
      {"femur", JointWord::upperLeg},
      {"lowerleg", JointWord::lowerLeg},
      {"shin", JointWord::lowerLeg},
      {"calf", JointWord::lowerLeg},
      {"knee", JointWord::lowerLeg},
      {"tibia", JointWord::lowerLeg},
      {"foot", JointWord::foot},
      {"ankle", JointWord::foot},
      {"toe", JointWord::toe},
      {"toes", JointWord::toe},
      {"toebase", JointWord::toe},
      {"ball", JointWord::toe},
      {"metatarsal", JointWord::toe},
      {"thumb", JointWord::thumb},
      {"index", JointWord::index},
      {"middle", JointWord::middle},
      {"mid", JointWord::middle},
      {"ring", JointWord::ring},
      {"pinky", JointWord::pinky},
      {"little", JointWord::pinky},
      {"finger", JointWord::finger},
      {"handfinger", JointWord::index}};
  return all;
}

// Helpers that no motion should drive, and tips that turn nothing.
bool isHelperWord(const std::string& word) {
  static const char* const all[] = {"ik",    "mch",    "ctrl", "control", "pole",      "target",
                                    "twist", "roll",   "end",  "nub",     "tip",       "sec",
                                    "leaf",  "helper", "site", "meta",    "metacarpal"};
  return std::any_of(std::begin(all), std::end(all), [&](const char* w) { return word == w; });
}

bool isPrefixWord(const std::string& word) {
  static const char* const all[] = {"def",   "org",      "mixamorig", "bip",  "j",     "b",
                                    "c",     "cc",       "jnt",       "bone", "sk",    "f",
                                    "biped", "skeleton", "armature",  "rig",  "joint", "valve"};
  return std::any_of(std::begin(all), std::end(all), [&](const char* w) { return word == w; });
}

bool takeSide(std::string& word, BodySide& side) {
  for (const auto& [text, value] :
       {std::pair{"left", BodySide::left}, {"right", BodySide::right}}) {
    const std::string_view is = text;
    if (word.starts_with(is)) {
      word.erase(0, is.size());
    } else if (word.ends_with(is)) {
      word.erase(word.size() - is.size());
    } else {
      continue;
    }
    side = value;
    return true;
  }
  if (word != "l" && word != "r") return false;
  side = word == "l" ? BodySide::left : BodySide::right;
  word.clear();
  return true;
}

bool lookUp(std::string_view word, JointReading& reading) {
  const auto& all = vocabulary();
  constexpr std::string_view kHand = "hand", kSuffixes[] = {"joint", "bone", "jnt"};
  auto found = all.find(word);
  // "wrist joint", "hips bone", "hand index": the other word alone.
  for (const std::string_view suffix : kSuffixes) {
    if (found != all.end() || !word.ends_with(suffix)) continue;
    word.remove_suffix(suffix.size());
    found = all.find(word);
  }
  if (found == all.end() && word.starts_with(kHand)) {
    word.remove_prefix(kHand.size());
    found = all.find(word);
  }
  if (found == all.end()) return false;
  reading.word = found->second;
  return reading.known = true;
}

}  // namespace

JointReading readJointName(std::string_view name) {
  if (JointReading japanese = readJapaneseJointName(name); japanese.known) return japanese;
  JointReading reading;
  Words words = wordsOf(name);
  std::string whole;
  bool numberOfPrefix = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string word = words[i];
    if (isHelperWord(word)) return {};
    if (isDigit(word[0])) {
      // Biped's "Bip01 …": the first number belongs to the prefix.
      if (!numberOfPrefix && !whole.empty() && reading.number.empty()) reading.number = word;
      numberOfPrefix = false;
      continue;
    }
    if (whole.empty() && isPrefixWord(word)) {
      numberOfPrefix = true;
      continue;
    }
    // "CC_Base_L_Thigh", but not "ToeBase".
    if (whole.empty() && word == "base") continue;
    // Which bone of a finger it is shows in the hierarchy.
    if (word == "proximal" || word == "intermediate" || word == "distal") continue;
    numberOfPrefix = false;
    takeSide(word, reading.side);
    whole += word;
  }
  if (lookUp(whole, reading) || whole.size() < 3 || reading.side != BodySide::middle) {
    return reading;
  }
  // "lthigh": a side that nothing separates.
  if ((whole[0] == 'l' || whole[0] == 'r') && lookUp(std::string_view(whole).substr(1), reading)) {
    reading.side = whole[0] == 'l' ? BodySide::left : BodySide::right;
  }
  return reading;
}

}  // namespace fascia
