#include <fascia/rig/joint_meaning.h>

#include <algorithm>
#include <cctype>
#include <unordered_map>

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

enum class Key {
  hips,
  hip,
  pelvis,
  hipJoint,
  spine,
  neck,
  head,
  shoulder,
  clavicle,
  arm,
  upperArm,
  lowerArm,
  hand,
  leg,
  upperLeg,
  lowerLeg,
  foot,
  toe,
  thumb,
  index,
  middle,
  ring,
  pinky,
  finger
};

const std::unordered_map<std::string_view, Key>& vocabulary() {
  static const std::unordered_map<std::string_view, Key> all = {{"hips", Key::hips},
                                                                {"humanoidroot", Key::hips},
                                                                {"hip", Key::hip},
                                                                {"pelvis", Key::pelvis},
                                                                {"hipjoint", Key::hipJoint},
                                                                {"spine", Key::spine},
                                                                {"chest", Key::spine},
                                                                {"upperchest", Key::spine},
                                                                {"chestlower", Key::spine},
                                                                {"chestupper", Key::spine},
                                                                {"abdomen", Key::spine},
                                                                {"abdomenlower", Key::spine},
                                                                {"abdomenupper", Key::spine},
                                                                {"lowerback", Key::spine},
                                                                {"back", Key::spine},
                                                                {"torso", Key::spine},
                                                                {"waist", Key::spine},
                                                                {"ribcage", Key::spine},
                                                                {"neck", Key::neck},
                                                                {"necklower", Key::neck},
                                                                {"neckupper", Key::neck},
                                                                {"head", Key::head},
                                                                {"skullbase", Key::head},
                                                                {"shoulder", Key::shoulder},
                                                                {"clavicle", Key::clavicle},
                                                                {"collar", Key::clavicle},
                                                                {"sternoclavicular", Key::clavicle},
                                                                {"arm", Key::arm},
                                                                {"upperarm", Key::upperArm},
                                                                {"uparm", Key::upperArm},
                                                                {"shldr", Key::upperArm},
                                                                {"shldrbend", Key::upperArm},
                                                                {"humerus", Key::upperArm},
                                                                {"forearm", Key::lowerArm},
                                                                {"lowerarm", Key::lowerArm},
                                                                {"elbow", Key::lowerArm},
                                                                {"forearmbend", Key::lowerArm},
                                                                {"radius", Key::lowerArm},
                                                                {"hand", Key::hand},
                                                                {"wrist", Key::hand},
                                                                {"leg", Key::leg},
                                                                {"upleg", Key::upperLeg},
                                                                {"upperleg", Key::upperLeg},
                                                                {"thigh", Key::upperLeg},
                                                                {"thighbend", Key::upperLeg},
                                                                {"femur", Key::upperLeg},
                                                                {"lowerleg", Key::lowerLeg},
                                                                {"shin", Key::lowerLeg},
                                                                {"calf", Key::lowerLeg},
                                                                {"knee", Key::lowerLeg},
                                                                {"tibia", Key::lowerLeg},
                                                                {"foot", Key::foot},
                                                                {"ankle", Key::foot},
                                                                {"toe", Key::toe},
                                                                {"toes", Key::toe},
                                                                {"toebase", Key::toe},
                                                                {"ball", Key::toe},
                                                                {"metatarsal", Key::toe},
                                                                {"thumb", Key::thumb},
                                                                {"index", Key::index},
                                                                {"middle", Key::middle},
                                                                {"mid", Key::middle},
                                                                {"ring", Key::ring},
                                                                {"pinky", Key::pinky},
                                                                {"little", Key::pinky},
                                                                {"finger", Key::finger},
                                                                {"handfinger", Key::index}};
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
  static const char* const all[] = {"def", "org", "mixamorig", "bip",   "j",  "b",     "c",
                                    "cc",  "jnt", "bone",      "valve", "sk", "biped", "f"};
  return std::any_of(std::begin(all), std::end(all), [&](const char* w) { return word == w; });
}

// A name taken apart.
struct Reading {
  bool known = false;
  Key key = Key::hips;
  BodySide side = BodySide::middle;
  std::string number;  // the first after the word
};

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

bool lookUp(std::string_view word, Reading& reading) {
  const auto& all = vocabulary();
  constexpr std::string_view kHand = "hand", kJoint = "joint";
  auto found = all.find(word);
  // "hand index", "wrist joint": the other word alone.
  if (found == all.end() && word.starts_with(kHand)) {
    word.remove_prefix(kHand.size());
    found = all.find(word);
  }
  if (found == all.end() && word.ends_with(kJoint)) {
    word.remove_suffix(kJoint.size());
    found = all.find(word);
  }
  if (found == all.end()) return false;
  reading.key = found->second;
  return reading.known = true;
}

Reading read(const std::string& name) {
  Reading reading;
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

// Words that mean different bones in different rigs, settled by what else there is on that side.
class Settler {
 public:
  explicit Settler(std::span<const Reading> readings) : readings_(readings) {
    fingersFromZero_ = std::any_of(readings.begin(), readings.end(), [](const Reading& r) {
      return r.known && r.key == Key::finger && !r.number.empty() && r.number[0] == '0';
    });
  }

  JointMeaning settle(const Reading& r) const {
    if (!r.known) return {};
    const BodyPart part = partOf(r);
    const bool sided = !isTrunk(part);
    if (sided && r.side == BodySide::middle) return {};
    if (!sided && r.side != BodySide::middle) return {};
    return {part, r.side};
  }

 private:
  bool has(Key key, BodySide side) const {
    return std::any_of(readings_.begin(), readings_.end(),
                       [&](const Reading& r) { return r.known && r.key == key && r.side == side; });
  }
  bool hasUpperArm(BodySide s) const { return has(Key::arm, s) || has(Key::upperArm, s); }
  bool hasThigh(BodySide s) const { return has(Key::upperLeg, s) || has(Key::hip, s); }

  BodyPart partOf(const Reading& r) const {
    const bool middle = r.side == BodySide::middle;
    switch (r.key) {
      case Key::hips:
        return BodyPart::hips;
      case Key::pelvis:
        return middle ? BodyPart::hips : BodyPart::pelvis;
      case Key::hip:
        if (middle) return BodyPart::hips;
        return has(Key::upperLeg, r.side) ? BodyPart::pelvis : BodyPart::upperLeg;
      case Key::hipJoint:
        return has(Key::upperLeg, r.side) ? BodyPart::pelvis : BodyPart::upperLeg;
      case Key::spine:
        return BodyPart::spine;
      case Key::neck:
        return BodyPart::neck;
      case Key::head:
        return BodyPart::head;
      case Key::shoulder:
        return hasUpperArm(r.side) ? BodyPart::clavicle : BodyPart::upperArm;
      case Key::clavicle:
        return BodyPart::clavicle;
      case Key::arm:
      case Key::upperArm:
        return BodyPart::upperArm;
      case Key::lowerArm:
        return BodyPart::lowerArm;
      case Key::hand:
        return BodyPart::hand;
      case Key::leg:
        return hasThigh(r.side) ? BodyPart::lowerLeg : BodyPart::upperLeg;
      case Key::upperLeg:
        return BodyPart::upperLeg;
      case Key::lowerLeg:
        return BodyPart::lowerLeg;
      case Key::foot:
        return BodyPart::foot;
      case Key::toe:
        return BodyPart::toe;
      case Key::thumb:
        return BodyPart::thumb;
      case Key::index:
        return BodyPart::index;
      case Key::middle:
        return BodyPart::middle;
      case Key::ring:
        return BodyPart::ring;
      case Key::pinky:
        return BodyPart::pinky;
      case Key::finger:
        return finger(r.number);
    }
    return BodyPart::unknown;
  }

  // "finger2-1": the number is the finger's; counted from the thumb, from 0 or 1.
  BodyPart finger(const std::string& number) const {
    const int first = number.empty() ? -1 : number[0] - '0' - (fingersFromZero_ ? 0 : 1);
    return first < 0 || first > 4
               ? BodyPart::unknown
               : static_cast<BodyPart>(static_cast<int>(BodyPart::thumb) + first);
  }

  std::span<const Reading> readings_;
  bool fingersFromZero_ = false;
};

std::vector<int> withPart(std::span<const JointMeaning> meanings,
                          std::initializer_list<BodyPart> parts) {
  std::vector<int> found;
  for (std::size_t j = 0; j < meanings.size(); ++j) {
    if (std::find(parts.begin(), parts.end(), meanings[j].part) != parts.end()) {
      found.push_back(static_cast<int>(j));
    }
  }
  return found;
}

// Trunk joints by where they stand between legs, arms and head.
void settleTrunk(std::span<const RigJoint> joints, std::vector<JointMeaning>& meanings) {
  const std::vector<int> named = withPart(meanings, {BodyPart::hips});
  const std::vector<int> heads = withPart(meanings, {BodyPart::head});
  const std::vector<int> legs = withPart(meanings, {BodyPart::upperLeg});
  const std::vector<int> arms = withPart(meanings, {BodyPart::upperArm});
  const int hips = !named.empty()     ? named.front()
                   : legs.size() >= 2 ? commonAncestor(joints, legs)
                                      : -1;
  if (hips < 0) return;
  for (const int other : named) meanings[static_cast<std::size_t>(other)] = {};
  if (heads.empty()) {
    meanings[static_cast<std::size_t>(hips)] = {BodyPart::hips, BodySide::middle};
    return;
  }
  std::vector<int> path;  // from the head, not included, down to the hips, not included
  int at = joints[static_cast<std::size_t>(heads.front())].parent;
  while (at >= 0 && at != hips) {
    path.push_back(at);
    at = joints[static_cast<std::size_t>(at)].parent;
  }
  meanings[static_cast<std::size_t>(hips)] = {BodyPart::hips, BodySide::middle};
  if (at != hips) return;
  const int chest = arms.size() >= 2 ? commonAncestor(joints, arms) : -1;
  if (std::find(path.begin(), path.end(), chest) == path.end()) return;
  for (JointMeaning& m : meanings) {
    if (m.part == BodyPart::spine || m.part == BodyPart::neck) m = {};  // beside the path
  }
  BodyPart part = BodyPart::neck;
  for (const int joint : path) {
    if (joint == chest) part = BodyPart::spine;
    meanings[static_cast<std::size_t>(joint)] = {part, BodySide::middle};
  }
}

}  // namespace

int commonAncestor(std::span<const RigJoint> joints, std::span<const int> of) {
  if (of.empty()) return -1;
  std::vector<std::size_t> seen(joints.size(), 0);
  for (const int joint : of) {
    for (int at = joint; at >= 0; at = joints[static_cast<std::size_t>(at)].parent) {
      ++seen[static_cast<std::size_t>(at)];
    }
  }
  // Parents come before children: the last joint that all have seen is the nearest.
  for (std::size_t j = joints.size(); j-- > 0;) {
    if (seen[j] == of.size()) return static_cast<int>(j);
  }
  return -1;
}

std::string describe(JointMeaning meaning) {
  static const char* const names[] = {
      "unknown",      "hips",          "spine",       "neck",         "head",
      "pelvis",       "upper leg",     "lower leg",   "foot",         "toe",
      "clavicle",     "upper arm",     "lower arm",   "hand",         "thumb",
      "index finger", "middle finger", "ring finger", "little finger"};
  const std::string side = meaning.side == BodySide::left    ? "left "
                           : meaning.side == BodySide::right ? "right "
                                                             : "";
  return side + names[static_cast<std::size_t>(meaning.part)];
}

std::vector<JointMeaning> guessMeanings(std::span<const RigJoint> joints) {
  std::vector<Reading> readings;
  for (const RigJoint& joint : joints) readings.push_back(read(joint.name));
  const Settler settler(readings);
  std::vector<JointMeaning> meanings;
  for (const Reading& reading : readings) meanings.push_back(settler.settle(reading));
  settleTrunk(joints, meanings);
  return meanings;
}

}  // namespace fascia
