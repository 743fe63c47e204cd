#include <fascia/flesh/bind.h>

#include <algorithm>

#include <fascia/base/suggest.h>
#include <fascia/flesh/names.h>

namespace fascia {
namespace {

// Postures and parameters are clamped when played: the person should know that a key is not met.
void warnOutside(const std::vector<Key>& keys, double min, double max, const std::string& pointer,
                 Diagnostics& diagnostics) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i].value >= min && keys[i].value <= max) continue;
    diagnostics.warning(pointer + "/keys/" + std::to_string(i),
                        "the value " + shortNumber(keys[i].value) + " lies outside [" +
                            shortNumber(min) + ", " + shortNumber(max) + "] and will be clamped");
  }
}

// Index into Posture::values; -1 after an error.
int bindJoint(const TrackDef& track, const Skeleton& skeleton, const std::string& pointer,
              Diagnostics& diagnostics) {
  const JointId joint = resolveJoint(skeleton, track.name, pointer + "/joint", diagnostics);
  const std::optional<Dof> dof = dofFromName(track.channel);
  if (!dof) {
    diagnostics.error(pointer + "/dof", "unknown degree of freedom " + quoted(track.channel),
                      "expected tx, ty, tz, rx, ry or rz");
  }
  if (!dof || !joint.valid()) return -1;
  const int value = resolveDof(skeleton, joint, *dof, pointer + "/dof", diagnostics);
  if (value < 0) return -1;
  const DofDef& limits = skeleton.valueDof(value);
  warnOutside(track.keys, limits.min, limits.max, pointer, diagnostics);
  return value;
}

SolidId bindSolid(const TrackDef& track, const Flesh& flesh, const Flesh& ornaments,
                  const std::string& pointer, Diagnostics& diagnostics) {
  const SolidId solid = flesh.find(track.name);
  if (solid.valid()) return solid;
  if (ornaments.find(track.name).valid()) {
    diagnostics.error(pointer + "/solid",
                      quoted(track.name) + " is an ornament: ornaments are rigid",
                      "make it one of the solids, or move its joint");
    return {};
  }
  NearestName nearest(track.name);
  for (std::size_t i = 0; i < flesh.solidCount(); ++i) {
    nearest.offer(flesh.def(SolidId{static_cast<std::int64_t>(i)}).name);
  }
  diagnostics.error(pointer + "/solid", "unknown solid " + quoted(track.name), nearest.hint());
  return {};
}

void bindTrack(const TrackDef& track, const Skeleton& skeleton, const Flesh& flesh,
               const Flesh& ornaments, const std::string& pointer, Diagnostics& diagnostics,
               double period_s, BoundClip& clip) {
  if (track.name.empty() || track.channel.empty()) return;  // reported by validateMotion
  if (track.target == TrackDef::Target::joint) {
    const int value = bindJoint(track, skeleton, pointer, diagnostics);
    if (value >= 0) clip.joints.push_back({value, KeySpline(track.keys, period_s)});
    return;
  }
  const SolidId solid = bindSolid(track, flesh, ornaments, pointer, diagnostics);
  if (!solid.valid()) return;
  const Solid& rest = flesh.restSolid(solid);
  const int parameter = resolveParameter(rest, track.channel, pointer + "/parameter", diagnostics);
  if (parameter < 0) return;
  const ParameterInfo& info = rest.parameterInfo(parameter);
  warnOutside(track.keys, info.min, info.max, pointer, diagnostics);
  clip.solids.push_back({solid.value, parameter, KeySpline(track.keys, period_s)});
}

}  // namespace

BoundClip bindMotion(const MotionDef& motion, const Skeleton& skeleton, const Flesh& flesh,
                     const Flesh& ornaments, const std::string& pointer, Diagnostics& diagnostics) {
  validateMotion(motion, pointer, diagnostics);
  BoundClip clip;
  clip.name = motion.name;
  clip.duration_s = playedDuration_s(motion);
  clip.loop = motion.loop;
  for (std::size_t i = 0; i < std::min(motion.tracks.size(), kMostTracks); ++i) {
    bindTrack(motion.tracks[i], skeleton, flesh, ornaments,
              pointer + "/tracks/" + std::to_string(i), diagnostics,
              clip.loop ? clip.duration_s : 0, clip);
  }
  return clip;
}

void samplePosture(const BoundClip& clip, const Skeleton& skeleton, double time_s,
                   Posture& posture) {
  posture.values.resize(skeleton.valueCount());
  posture.rates.assign(skeleton.valueCount(), 0.0);
  for (std::size_t i = 0; i < posture.values.size(); ++i) {
    posture.values[i] = skeleton.valueDof(static_cast<int>(i)).rest;
  }
  for (const BoundClip::JointTrack& track : clip.joints) {
    const SplineSample sample = track.spline.at(time_s);
    posture.values[static_cast<std::size_t>(track.value)] = sample.value;
    posture.rates[static_cast<std::size_t>(track.value)] = sample.rate;
  }
  skeleton.clampToLimits(posture);
}

void sampleParameters(const BoundClip& clip, double time_s,
                      std::vector<Flesh::ParameterOverride>& overrides) {
  overrides.clear();
  for (const BoundClip::SolidTrack& track : clip.solids) {
    const SplineSample sample = track.spline.at(time_s);
    overrides.push_back({SolidId{static_cast<std::int64_t>(track.solid)}, track.parameter,
                         sample.value, sample.rate});
  }
}

}  // namespace fascia
