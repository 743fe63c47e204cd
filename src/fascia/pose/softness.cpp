#include <fascia/pose/softness.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include <fascia/pose/joint_motion.h>
#include <fascia/rig/joint_meaning.h>

namespace fascia {
namespace {

// Limbs of these radii (share of the figure's size) begin to be soft, and are wholly so.
constexpr float kHardRadius = 0.012f, kSoftRadius = 0.047f;
// Ears and tails are soft however thin they are.
constexpr float kFloppy = 0.6f;
constexpr int kBlendPasses = 12;
constexpr float kWhole = 0.999f;

enum class Firmness { byThickness, hard, floppy };

Firmness firmnessOf(const std::string& name, JointMeaning meaning) {
  switch (meaning.part) {
    case BodyPart::head:
    case BodyPart::hand:
    case BodyPart::foot:
    case BodyPart::toe:
      return Firmness::hard;
    default:
      break;
  }
  if (isFinger(meaning.part)) return Firmness::hard;
  std::string word;
  for (const char c : name) word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto has = [&](std::string_view part) { return word.find(part) != std::string::npos; };
  for (const std::string_view part : {"tail", "floppy", "jowl", "belly"})
    if (has(part)) return Firmness::floppy;
  if (word.starts_with("ear") || has("_ear") || has(".ear") || has("ear_") || has("ear.") ||
      word.ends_with("ear"))
    return Firmness::floppy;
  for (const std::string_view part :
       {"head", "jaw",    "chin",  "nose",  "eye",   "hand", "foot",
        "toe",  "finger", "thumb", "skull", "beak",  "horn", "hoof",
        "paw",  "claw",   "teeth", "tooth", "mouth", "lip",  "tongue"})
    if (has(part)) return Firmness::hard;
  return Firmness::byThickness;
}

}  // namespace

std::vector<char> stiffPieces(const PoseSource& source) {
  const std::size_t count = source.points.size();
  std::vector<char> stiff(count, 0), seen(count, 0);
  std::vector<std::vector<std::uint32_t>> around(count);
  for (const auto& t : source.triangles)
    for (std::size_t k = 0; k < 3; ++k) around[t[k]].push_back(t[(k + 1) % 3]);
  std::vector<std::uint32_t> piece;
  for (std::uint32_t first = 0; first < count; ++first) {
    if (seen[first]) continue;
    piece.assign(1, first);
    seen[first] = 1;
    bool rigid = true;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const PointWeights& w = source.weights[piece[k]];
      rigid = rigid && w.weight[0] >= kWhole && w.joint[0] == source.weights[first].joint[0];
      for (const std::uint32_t next : around[piece[k]])
        if (!seen[next]) seen[next] = 1, piece.push_back(next);
    }
    if (rigid)
      for (const std::uint32_t i : piece) stiff[i] = 1;
  }
  return stiff;
}

std::vector<float> softnessOf(const PoseSource& source, const PoseMesh& mesh,
                              const LimbParts& parts) {
  const std::vector<JointMeaning> meanings = guessMeanings(source.joints);
  std::vector<Firmness> firmness;
  for (std::size_t j = 0; j < source.joints.size(); ++j)
    firmness.push_back(firmnessOf(source.joints[j].name, meanings[j]));
  std::vector<float> soft(mesh.size());
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const float radius = parts.radius_m[i] / mesh.size_m;
    const float thick = smoothStep((radius - kHardRadius) / (kSoftRadius - kHardRadius));
    switch (firmness[parts.home[i]]) {
      case Firmness::hard:
        soft[i] = 0;
        break;
      case Firmness::floppy:
        soft[i] = std::max(kFloppy, thick);
        break;
      case Firmness::byThickness:
        soft[i] = parts.part[parts.home[i]].exists() ? thick : 0;
        break;
    }
  }
  smoothAlongEdges(mesh, kBlendPasses, soft);
  const std::vector<char> stiff = stiffPieces(source);
  for (std::size_t i = 0; i < mesh.size(); ++i)
    if (stiff[i]) soft[i] = 0;
  return soft;
}

}  // namespace fascia
