#include <fascia/rig/joint_map.h>

#include <algorithm>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include <fascia/base/error.h>
#include <fascia/base/index.h>
#include <fascia/base/suggest.h>
#include <fascia/rig/joint_meaning.h>

namespace fascia {
namespace {

using Ids = std::vector<int>;

// The name as two files of the same rig share it: without namespace, small letters.
std::string bareName(std::string_view name) {
  const std::size_t space = name.find_last_of(":|");
  if (space != std::string_view::npos) name.remove_prefix(space + 1);
  std::string bare;
  for (const char c : name) bare += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return bare;
}

struct Found {
  int source = -1;
  std::string why;
};

class Guesser {
 public:
  Guesser(std::span<const RigJoint> source, std::span<const RigJoint> target,
          const SaidJoints& said)
      : source_(source),
        target_(target),
        sourceMeanings_(guessMeanings(source, said.source)),
        targetMeanings_(guessMeanings(target, said.target)),
        found_(target.size()),
        isFixed_(target.size(), false) {}

  void give(const JointPair& pair, std::unordered_set<std::string>& silent,
            std::vector<Issue>& issues);
  void guess(const std::unordered_set<std::string>& silent);
  void dropContradictions(std::vector<std::string>* notes);
  JointMap map() const;

 private:
  void pairNames();
  void pairParts();
  void pairPart(JointMeaning meaning, const Ids& sources, const Ids& targets);
  void pairToes(const Ids& sources, const Ids& targets);
  void pairLoneFingers(BodySide side);
  void pair(int source, int target, const std::string& why);
  Ids joints(std::span<const JointMeaning> meanings, JointMeaning meaning) const;
  bool isAbove(int above, int joint) const;
  std::size_t sameNames() const;

  std::span<const RigJoint> source_, target_;
  std::vector<JointMeaning> sourceMeanings_, targetMeanings_;
  std::vector<Found> found_;        // per target
  std::vector<bool> isFixed_;       // per target: given by a person
  std::unordered_set<int> silent_;  // sources that shall drive nothing
};

std::unordered_map<std::string, int> byBareName(std::span<const RigJoint> joints) {
  std::unordered_map<std::string, int> names;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    names.try_emplace(bareName(joints[j].name), static_cast<int>(j));
  }
  return names;
}

// -1 if there is none of that name, which becomes an issue.
int findJoint(std::span<const RigJoint> joints, const std::string& name, const char* where,
              int line, std::vector<Issue>& issues) {
  constexpr std::size_t kEnough = 100;  // a person reads no more; a hostile file has millions
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (joints[j].name == name) return static_cast<int>(j);
  if (issues.size() >= kEnough) return -1;
  NearestName nearest(name);
  for (const RigJoint& joint : joints) nearest.offer(joint.name);
  issues.push_back({{{}, line, {}},
                    std::string("the joint map names ") + quotedName(name) + ", which " + where +
                        " does not have",
                    nearest.hint()});
  return -1;
}

void Guesser::give(const JointPair& pair, std::unordered_set<std::string>& silent,
                   std::vector<Issue>& issues) {
  const int source = findJoint(source_, pair.source, "the motion", pair.line, issues);
  silent.insert(pair.source);
  if (pair.target.empty()) return;
  const int target = findJoint(target_, pair.target, "the rig", pair.line, issues);
  if (source < 0 || target < 0) return;
  found_[at(target)] = {source, "given"};
  isFixed_[at(target)] = true;
}

void Guesser::pair(int source, int target, const std::string& why) {
  if (found_[at(target)].source >= 0 || silent_.contains(source)) return;
  found_[at(target)] = {source, why};
}

std::size_t Guesser::sameNames() const {
  const auto names = byBareName(source_);
  return static_cast<std::size_t>(
      std::count_if(target_.begin(), target_.end(),
                    [&](const RigJoint& j) { return names.contains(bareName(j.name)); }));
}

void Guesser::pairNames() {
  const auto names = byBareName(source_);
  for (std::size_t t = 0; t < target_.size(); ++t) {
    // In chains of unequal length equal names are not the same bones.
    const JointMeaning meaning = targetMeanings_[t];
    const bool isChain = meaning.part == BodyPart::spine || meaning.part == BodyPart::neck;
    if (isChain &&
        joints(sourceMeanings_, meaning).size() != joints(targetMeanings_, meaning).size()) {
      continue;
    }
    const auto same = names.find(bareName(target_[t].name));
    if (same != names.end()) pair(same->second, static_cast<int>(t), "same name");
  }
}

Ids Guesser::joints(std::span<const JointMeaning> meanings, JointMeaning meaning) const {
  Ids found;
  for (std::size_t j = 0; j < meanings.size(); ++j) {
    if (meanings[j] == meaning) found.push_back(static_cast<int>(j));
  }
  return found;
}

// Chains of different lengths: the last joint (chest, wrist's end of the arm) is driven by the
// last, the others evenly. What is skipped is not lost: rotations are taken in the world.
void Guesser::pairPart(JointMeaning meaning, const Ids& sources, const Ids& targets) {
  if (sources.empty()) return;
  const std::size_t m = sources.size(), n = targets.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::string why = describe(meaning);
    if (n > 1 || m > 1) {
      why.append(" ").append(std::to_string(i + 1)).append(" of ").append(std::to_string(n));
    }
    if (isFinger(meaning.part)) {
      if (i < m) pair(sources[i], targets[i], why);
      continue;
    }
    pair(sources[(i * m + m + n - 1) / n - 1], targets[i], why);
  }
}

// Toes stand side by side: one source drives them all.
void Guesser::pairToes(const Ids& sources, const Ids& targets) {
  if (sources.empty()) return;
  for (const int target : targets) {
    const int parent = target_[at(target)].parent;
    const bool first = parent < 0 || targetMeanings_[at(parent)].part != BodyPart::toe;
    if (first) pair(sources.front(), target, describe(targetMeanings_[at(target)]));
  }
}

// Many captures have one finger that stands for all four.
void Guesser::pairLoneFingers(BodySide side) {
  static constexpr BodyPart kFour[] = {BodyPart::index, BodyPart::middle, BodyPart::ring,
                                       BodyPart::pinky};
  Ids lone;
  int fingers = 0;
  for (const BodyPart part : kFour) {
    const Ids here = joints(sourceMeanings_, {part, side});
    if (!here.empty()) lone = here, ++fingers;
  }
  if (fingers != 1) return;
  for (const BodyPart part : kFour) {
    const Ids targets = joints(targetMeanings_, {part, side});
    for (std::size_t i = 0; i < std::min(lone.size(), targets.size()); ++i) {
      pair(lone[i], targets[i], "the only finger");
    }
  }
}

void Guesser::pairParts() {
  for (const BodySide side : {BodySide::middle, BodySide::left, BodySide::right}) {
    for (int p = static_cast<int>(BodyPart::hips); p <= static_cast<int>(BodyPart::pinky); ++p) {
      const JointMeaning meaning{static_cast<BodyPart>(p), side};
      const Ids sources = joints(sourceMeanings_, meaning);
      const Ids targets = joints(targetMeanings_, meaning);
      if (meaning.part == BodyPart::toe) {
        pairToes(sources, targets);
      } else {
        pairPart(meaning, sources, targets);
      }
    }
    pairLoneFingers(side);
  }
}

void Guesser::guess(const std::unordered_set<std::string>& silent) {
  for (std::size_t s = 0; s < source_.size(); ++s) {
    if (silent.contains(source_[s].name)) silent_.insert(static_cast<int>(s));
  }
  // Most names in common: one rig, or one convention. Otherwise equal words may mean other bones
  // (a "Spine1" of two and of three), so that meaning comes first.
  const bool oneConvention = 10 * sameNames() >= 7 * std::min(source_.size(), target_.size());
  if (oneConvention) pairNames();
  pairParts();
  if (!oneConvention) pairNames();
}

bool Guesser::isAbove(int above, int joint) const {
  while (joint > above) joint = source_[at(joint)].parent;
  return joint == above;
}

// A joint below another must be driven from below (or by the same): else one of the two is wrong,
// and a guess is given up before what a person gave.
void Guesser::dropContradictions(std::vector<std::string>* notes) {
  for (std::size_t t = 0; t < target_.size(); ++t) {
    if (found_[t].source < 0 || isFixed_[t]) continue;
    int above = target_[t].parent;
    while (above >= 0 && found_[at(above)].source < 0) above = target_[at(above)].parent;
    if (above < 0 || isAbove(found_[at(above)].source, found_[t].source)) continue;
    if (notes) {
      notes->push_back(quotedName(target_[t].name) +
                       " is not driven: " + quotedName(source_[at(found_[t].source)].name) + " (" +
                       found_[t].why + ") does not lie below " +
                       quotedName(source_[at(found_[at(above)].source)].name));
    }
    found_[t] = {};
  }
}

JointMap Guesser::map() const {
  JointMap map;
  for (std::size_t t = 0; t < target_.size(); ++t) {
    if (found_[t].source < 0) continue;
    map.push_back({source_[at(found_[t].source)].name, target_[t].name, found_[t].why});
  }
  return map;
}

}  // namespace

JointMap guessJointMap(std::span<const RigJoint> source, std::span<const RigJoint> target,
                       std::span<const JointPair> given, std::vector<std::string>* notes,
                       const SaidJoints& said) {
  Guesser guesser(source, target, said);
  std::unordered_set<std::string> silent;
  std::vector<Issue> issues;
  for (const JointPair& pair : given) guesser.give(pair, silent, issues);
  if (!issues.empty()) throw Error(std::move(issues));
  guesser.guess(silent);
  guesser.dropContradictions(notes);
  return guesser.map();
}

JointMap parseJointMap(std::string_view text, const std::string& file) {
  const auto trim = [](std::string_view part) {
    const std::size_t first = part.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return std::string();
    return std::string(part.substr(first, part.find_last_not_of(" \t\r") - first + 1));
  };
  JointMap map;
  int line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view whole = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string content = trim(whole.substr(0, whole.find('#')));
    if (content.empty()) continue;
    const std::size_t sign = content.find('=');
    const std::string source = trim(std::string_view(content).substr(0, sign));
    if (sign == std::string::npos || source.empty()) {
      Issue issue;
      issue.where = {file, line, {}};
      issue.message = std::string("found ") + quotedName(content) + ", expected 'source = target'";
      throw Error(std::move(issue));
    }
    map.push_back({source, trim(std::string_view(content).substr(sign + 1)), "given", line});
  }
  return map;
}

std::string printJointMap(const JointMap& map) {
  std::size_t longest = 0;
  for (const JointPair& p : map) {
    longest = std::max(longest, p.source.size() + 3 + p.target.size());
  }
  std::string text;
  for (const JointPair& p : map) {
    std::string line = p.source + " = " + p.target;
    line.resize(std::max(line.size(), longest), ' ');
    text += line + "  # " + p.why + "\n";
  }
  return text;
}

}  // namespace fascia
