#include <fascia/io/state/state_file.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/hash.h>
#include <fascia/io/file/file.h>
#include <fascia/io/state/state_stream.h>
#include <fascia/io/state/state_traits.h>
#include <fascia/skin/carry_over.h>

namespace fascia {
namespace {

// Layout, little-endian: magic; u32 version; u64 length of the rest after the hash; u64 StateHash
// of it; the traits of the character; the members in their order.
constexpr std::string_view kStateMagic("FSTATE\x1a\n", 8);
constexpr std::uint32_t kStateVersion = 2;  // 1 had no morphs
constexpr std::size_t kMaxStateBytes = std::size_t{1} << 30;
// Later, times are too coarse for steps.
constexpr double kLatestState_s = 1e9;
// As far as joints without limits go.
constexpr double kFarthestValue = 1e9;
constexpr double kUnitTolerance = 1e-6;

std::uint64_t hashOfBytes(std::string_view bytes) {
  StateHash hash;
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

bool isWithin(const std::vector<double>& values, double limit) {
  return std::ranges::all_of(values, [&](double x) { return std::abs(x) <= limit; });
}

// As resolveRotations() leaves them: increasing, of joints that turn about all axes.
bool areResolved(const std::vector<JointRotation>& rotations, const Skeleton& skeleton) {
  int last = -1;
  for (const JointRotation& r : rotations) {
    if (r.joint.value <= last || r.joint.index() >= skeleton.jointCount()) return false;
    for (const Dof dof : {Dof::rx, Dof::ry, Dof::rz})
      if (skeleton.valueIndex(r.joint, dof) < 0) return false;
    if (!(std::abs(r.rotation.norm() - 1) < kUnitTolerance)) return false;
    last = r.joint.value;
  }
  return true;
}

bool fitsPosture(const Skeleton& skeleton, const Posture& posture) {
  const std::size_t count = skeleton.valueCount();
  return posture.values.size() == count && posture.rates.size() == count &&
         isWithin(posture.values, kFarthestValue) && areResolved(posture.rotations, skeleton);
}

// Parameters that were applied are those that a source may say.
bool fitParameters(const Character& character, const CharacterState& state) {
  PostureSample sample{.posture = {}, .parameters = state.sampled.parameters};
  admit(character.figure(), state.posture, sample);
  return sample.parameters.size() == state.sampled.parameters.size();
}

bool fitMorphs(const Morphs& morphs, const MorphPose& pose) {
  return pose.weights.size() == morphs.size() && pose.rates.size() == morphs.size() &&
         isWithin(pose.weights, kMostMorphWeight);
}

bool fitsBodies(const SoftFlesh* soft, const CharacterState& state) {
  const OdeState& bodies = state.bodies;
  if (!soft) return bodies.r.empty() && bodies.v.empty();
  const std::size_t size = soft->model().size();
  return bodies.r.size() == size && bodies.v.size() == size && bodies.t_s == state.time_s;
}

bool fitsSkinNumbers(const SkinState& skin, std::size_t joints) {
  return (skin.joints.empty() || skin.joints.size() == joints) && skin.jiggle.frames >= 0 &&
         skin.jiggle.frames <= 2 && skin.maxSpeed_m_per_s >= 0 && skin.odeStep_s >= 0 &&
         std::ranges::all_of(skin.coarse,
                             [&](const SkinState& s) { return fitsSkinNumbers(s, joints); });
}

// What is wrong with a state of finite numbers; nullptr: nothing.
const char* problemOf(const Character& character, const CharacterState& state) {
  if (std::abs(state.time_s) > kLatestState_s) return "time";
  if (!fitsPosture(character.skeleton(), state.posture)) return "posture";
  if (!fitParameters(character, state)) return "parameters of solids";
  if (!fitMorphs(character.morphs(), state.morphs)) return "weights of morphs";
  if (!fitsBodies(character.softFlesh().get(), state)) return "soft solids";
  if (!character.skin()) return state.skin.position.x.empty() ? nullptr : "skin";
  if (!fitsSkinNumbers(state.skin, character.skeleton().jointCount())) return "skin";
  return misfit(*character.skin(), state.skin);
}

// What follows from the rest.
void poseLayersAgain(const Character& character, CharacterState& state) {
  character.skeleton().pose(state.posture, state.skeleton);
  character.flesh().pose(state.posture, state.skeleton, state.sampled.parameters,
                         state.flesh.rigid());
  character.ornaments().pose(state.posture, state.skeleton, {}, state.ornaments);
  if (!character.softFlesh()) return;
  character.softFlesh()->prepare(state.flesh);
  state.flesh.soft().update(state.bodies.r, state.bodies.v);
}

// The bytes that the hash is of.
std::string_view openState(ByteReader& in) {
  if (in.left() < kStateMagic.size() || in.take(kStateMagic.size()) != kStateMagic)
    in.fail("is not the state of a character");
  const auto version = in.value<std::uint32_t>();
  if (version != kStateVersion)
    in.fail("has state format " + std::to_string(version) + ", this program reads format " +
            std::to_string(kStateVersion));
  const auto size = in.value<std::uint64_t>();
  const auto hash = in.value<std::uint64_t>();
  if (size > in.left()) in.fail("is cut short");
  if (size < in.left()) in.fail("has bytes after its end");
  const std::string_view content = in.take(in.left());
  if (hashOfBytes(content) != hash) in.fail("is damaged: its bytes are not those that were saved");
  return content;
}

}  // namespace

std::string saveState(const Character& character, const CharacterState& state) {
  if (const char* what = problemOf(character, state))
    throw Error("the state is not one of this character; what does not fit: " + std::string(what));
  ByteWriter content;
  writeTraits(character, content);
  StateWriter write(content);
  write(state);
  ByteWriter out;
  out.bytes = kStateMagic;
  out.value(kStateVersion);
  out.value(static_cast<std::uint64_t>(content.bytes.size()));
  out.value(hashOfBytes(content.bytes));
  return out.bytes + content.bytes;
}

CharacterState loadState(const Character& character, std::string_view bytes,
                         const std::string& file) {
  ByteReader whole(bytes, file);
  ByteReader in(openState(whole), file);
  requireTraits(character, in);
  CharacterState state;
  StateReader read(in);
  read(state);
  if (in.left() > 0) in.fail("has bytes after its end");
  if (const char* what = problemOf(character, state))
    in.fail("is no state of this character; what does not fit: " + std::string(what));
  poseLayersAgain(character, state);
  return state;
}

void writeStateFile(const Character& character, const CharacterState& state,
                    const std::string& path) {
  writeFileWhole(path, saveState(character, state));
}

CharacterState readStateFile(const Character& character, const std::string& path) {
  return loadState(character, readFile(path, kMaxStateBytes), path);
}

}  // namespace fascia
