#include <fascia/rig/joint_meaning.h>

#include <algorithm>
#include <array>

#include <fascia/base/assert.h>
#include <fascia/base/index.h>
#include <fascia/rig/joint_words.h>

namespace fascia {
namespace {

// Words that mean different bones in different rigs, settled by what else there is on that side.
class Settler {
 public:
  explicit Settler(std::span<const JointReading> readings) : readings_(readings) {
    fingersFromZero_ = std::any_of(readings.begin(), readings.end(), [](const JointReading& r) {
      return r.known && r.word == JointWord::finger && !r.number.empty() && r.number[0] == '0';
    });
  }

  JointMeaning settle(const JointReading& r) const {
    if (!r.known) return {};
    const BodyPart part = partOf(r);
    const bool sided = !isTrunk(part);
    if (sided && r.side == BodySide::middle) return {};
    if (!sided && r.side != BodySide::middle) return {};
    return {part, r.side};
  }

 private:
  bool has(JointWord word, BodySide side) const {
    return std::any_of(readings_.begin(), readings_.end(), [&](const JointReading& r) {
      return r.known && r.word == word && r.side == side;
    });
  }
  bool hasUpperArm(BodySide s) const {
    return has(JointWord::arm, s) || has(JointWord::upperArm, s);
  }
  bool hasThigh(BodySide s) const { return has(JointWord::upperLeg, s) || has(JointWord::hip, s); }

  BodyPart partOf(const JointReading& r) const {
    const bool middle = r.side == BodySide::middle;
    switch (r.word) {
      case JointWord::hips:
        return BodyPart::hips;
      case JointWord::pelvis:
        return middle ? BodyPart::hips : BodyPart::pelvis;
      case JointWord::hip:
        if (middle) return BodyPart::hips;
        return has(JointWord::upperLeg, r.side) ? BodyPart::pelvis : BodyPart::upperLeg;
      case JointWord::hipJoint:
        return has(JointWord::upperLeg, r.side) ? BodyPart::pelvis : BodyPart::upperLeg;
      case JointWord::spine:
        return BodyPart::spine;
      case JointWord::neck:
        return BodyPart::neck;
      case JointWord::head:
        return BodyPart::head;
      case JointWord::shoulder:
        return hasUpperArm(r.side) ? BodyPart::clavicle : BodyPart::upperArm;
      case JointWord::clavicle:
        return BodyPart::clavicle;
      case JointWord::arm:
      case JointWord::upperArm:
        return BodyPart::upperArm;
      case JointWord::lowerArm:
        return BodyPart::lowerArm;
      case JointWord::hand:
        return BodyPart::hand;
      case JointWord::leg:
        return hasThigh(r.side) ? BodyPart::lowerLeg : BodyPart::upperLeg;
      case JointWord::upperLeg:
        return BodyPart::upperLeg;
      case JointWord::lowerLeg:
        return BodyPart::lowerLeg;
      case JointWord::foot:
        return BodyPart::foot;
      case JointWord::toe:
        return BodyPart::toe;
      case JointWord::thumb:
        return BodyPart::thumb;
      case JointWord::index:
        return BodyPart::index;
      case JointWord::middle:
        return BodyPart::middle;
      case JointWord::ring:
        return BodyPart::ring;
      case JointWord::pinky:
        return BodyPart::pinky;
      case JointWord::finger:
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

  std::span<const JointReading> readings_;
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
  int hips = !named.empty() ? named.front() : legs.size() >= 2 ? commonAncestor(joints, legs) : -1;
  if (hips < 0) return;
  // A lower body beside the upper one: what holds both.
  if (!heads.empty()) {
    const std::array ends{hips, heads.front()};
    const int both = commonAncestor(joints, ends);
    if (both >= 0) hips = both;
  }
  for (const int other : named) meanings[static_cast<std::size_t>(other)] = {};
  if (heads.empty()) {
    meanings[static_cast<std::size_t>(hips)] = {BodyPart::hips, BodySide::middle};
    return;
  }
  std::vector<int> path;  // from the head, not included, down to the hips, not included
  int above = joints[at(heads.front())].parent;
  while (above >= 0 && above != hips) {
    path.push_back(above);
    above = joints[at(above)].parent;
  }
  meanings[static_cast<std::size_t>(hips)] = {BodyPart::hips, BodySide::middle};
  if (above != hips) return;
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

bool isBelow(std::span<const RigJoint> joints, int joint, int above) {
  while (joint > above) joint = joints[at(joint)].parent;
  return joint == above;
}

// Joints that are read as one and the same limb, if they hang below each other.
std::vector<int> chainOf(std::span<const RigJoint> joints, std::span<const JointReading> readings,
                         JointWord word, BodySide side) {
  std::vector<int> chain;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointReading& r = readings[j];
    if (!r.known || r.word != word || r.side != side) continue;
    if (!chain.empty() && !isBelow(joints, static_cast<int>(j), chain.back())) return {};
    chain.push_back(static_cast<int>(j));
  }
  return chain;
}

double boneLength_m(std::span<const RigJoint> joints, int a, int b) {
  return (joints[at(a)].rest_world.translation_m - joints[at(b)].rest_world.translation_m).norm();
}

// "arm_1" to "arm_4" are no four upper arms: what they are shows along the chain.
void settleNumberedLimb(std::span<const RigJoint> joints, std::span<const JointReading> readings,
                        JointWord word, BodySide side, std::vector<JointMeaning>& meanings) {
  constexpr std::size_t kLeastJoints = 3;
  constexpr double kShort = 0.75;  // of the next bone: a collar bone rather than an upper arm
  const bool isArm = word == JointWord::arm;
  const auto others = isArm
                          ? std::vector{JointWord::upperArm, JointWord::lowerArm, JointWord::hand}
                          : std::vector{JointWord::upperLeg, JointWord::lowerLeg, JointWord::foot};
  for (const JointReading& r : readings)
    if (r.known && r.side == side && std::ranges::find(others, r.word) != others.end()) return;
  const std::vector<int> chain = chainOf(joints, readings, word, side);
  if (chain.size() < kLeastJoints) return;
  std::vector<BodyPart> parts{BodyPart::upperLeg, BodyPart::lowerLeg, BodyPart::foot,
                              BodyPart::toe};
  if (isArm) {
    const double first_m = boneLength_m(joints, chain[0], chain[1]),
                 second_m = boneLength_m(joints, chain[1], chain[2]);
    const bool known = second_m > 0;
    const bool collar = known ? first_m < kShort * second_m : chain.size() > kLeastJoints;
    parts = {BodyPart::upperArm, BodyPart::lowerArm, BodyPart::hand};
    if (collar) parts.insert(parts.begin(), BodyPart::clavicle);
  }
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const bool named = i < parts.size();
    meanings[at(chain[i])] = named ? JointMeaning{parts[i], side} : JointMeaning{};
  }
}

// Of several joints of the neck the last is the head, where nothing else is.
void settleNumberedNeck(std::span<const RigJoint> joints, std::span<const JointReading> readings,
                        std::vector<JointMeaning>& meanings) {
  if (!withPart(meanings, {BodyPart::head}).empty()) return;
  const std::vector<int> chain = chainOf(joints, readings, JointWord::neck, BodySide::middle);
  if (chain.size() >= 2) meanings[at(chain.back())] = {BodyPart::head, BodySide::middle};
}

std::vector<JointReading> readingsOf(std::span<const RigJoint> joints,
                                     std::span<const std::string> said) {
  constexpr std::string_view kThumbRoot = "Metacarpal";
  std::vector<JointReading> readings;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (said.empty()) {
      readings.push_back(readJointName(joints[j].name));
      continue;
    }
    std::string_view bone = said[j];
    if (bone.ends_with(kThumbRoot)) bone.remove_suffix(kThumbRoot.size());
    readings.push_back(readJointName(bone));
  }
  return readings;
}

}  // namespace

int commonAncestor(std::span<const RigJoint> joints, std::span<const int> of) {
  if (of.empty()) return -1;
  std::vector<std::size_t> seen(joints.size(), 0);
  for (const int joint : of) {
    for (int above = joint; above >= 0; above = joints[at(above)].parent) ++seen[at(above)];
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

std::vector<JointMeaning> guessMeanings(std::span<const RigJoint> joints,
                                        std::span<const std::string> said) {
  FASCIA_ASSERT(said.empty() || said.size() == joints.size(), "one word for each joint");
  const std::vector<JointReading> readings = readingsOf(joints, said);
  const Settler settler(readings);
  std::vector<JointMeaning> meanings;
  meanings.reserve(readings.size());
  for (const JointReading& reading : readings) meanings.push_back(settler.settle(reading));
  for (const BodySide side : {BodySide::left, BodySide::right}) {
    for (const JointWord word : {JointWord::arm, JointWord::leg})
      settleNumberedLimb(joints, readings, word, side, meanings);
  }
  settleNumberedNeck(joints, readings, meanings);
  settleTrunk(joints, meanings);
  return meanings;
}

}  // namespace fascia
