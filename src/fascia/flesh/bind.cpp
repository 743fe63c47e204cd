#include <fascia/flesh/bind.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/suggest.h>
#include <fascia/flesh/names.h>
#include <fascia/skeleton/euler.h>

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
    diagnostics.error(pointer + "/dof", "unknown degree of freedom " + quotedName(track.channel),
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
                      quotedName(track.name) + " is an ornament: ornaments are rigid",
                      "make it one of the solids, or move its joint");
    return {};
  }
  NearestName nearest(track.name);
  for (std::size_t i = 0; i < flesh.solidCount(); ++i) {
    nearest.offer(flesh.def(SolidId{static_cast<std::int64_t>(i)}).name);
  }
  diagnostics.error(pointer + "/solid", "unknown solid " + quotedName(track.name), nearest.hint());
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

constexpr Dof kAllDofs[] = {Dof::tx, Dof::ty, Dof::tz, Dof::rx, Dof::ry, Dof::rz};

// Index of the first of a joint's six values; -1 if it has others.
int firstOfSix(const Skeleton& skeleton, JointId joint) {
  const int first = skeleton.valueIndex(joint, Dof::tx);
  for (int i = 0; i < 6; ++i)
    if (skeleton.valueIndex(joint, kAllDofs[i]) != first + i) return -1;
  return first;
}

// A joint's own turn and shift at a time of a sampled motion.
Transform sampledOwn(const BoundClip& clip, const BoundClip::SampledJoint& joint, double time_s) {
  return joint.before * sampleJoint(*clip.sampled, joint.sample, time_s) * joint.after;
}

// Half the time over which rates are measured.
constexpr double kRateSpan_s = 1.0 / 240;

void sampleFrames(const BoundClip& clip, double time_s, Posture& posture) {
  const bool still = !clip.loop && (time_s <= 0 || time_s >= clip.duration_s);
  for (const BoundClip::SampledJoint& joint : clip.sampledJoints) {
    const Transform now = sampledOwn(clip, joint, time_s);
    const Vec3 angles = anglesZyx(now.rotation);
    Vec3 linear = Vec3::Zero(), rates = Vec3::Zero();
    if (!still) {
      const Transform before = sampledOwn(clip, joint, time_s - kRateSpan_s);
      const Transform after = sampledOwn(clip, joint, time_s + kRateSpan_s);
      linear = (after.translation_m - before.translation_m) / (2 * kRateSpan_s);
      const Eigen::AngleAxisd turn(Mat3(after.rotation * before.rotation.transpose()));
      rates = angleRatesZyx(angles, turn.axis() * (turn.angle() / (2 * kRateSpan_s)));
    }
    for (int a = 0; a < 3; ++a) {
      const std::size_t shift = joint.firstValue + static_cast<std::size_t>(a), angle = shift + 3;
      posture.values[shift] = now.translation_m[a];
      posture.rates[shift] = linear[a];
      posture.values[angle] = angles[a];
      posture.rates[angle] = rates[a];
    }
  }
}

}  // namespace

BoundClip bindSampled(std::shared_ptr<const SampledMotion> motion,
                      std::span<const SampledFrame> frames, const Skeleton& skeleton,
                      const std::string& pointer, Diagnostics& diagnostics) {
  BoundClip clip;
  clip.name = motion->name;
  clip.duration_s = motion->duration_s();
  clip.loop = motion->loop;
  PosedSkeleton rest;
  skeleton.pose(skeleton.restPosture(), rest);
  // From the samples' frame to the skeleton's, in the frame of the former.
  const auto change = [&](const SampledFrame& frame, JointId joint) {
    return frame.rest_world.inverse() * rest.joint_world[joint.index()];
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const JointId joint = resolveJoint(skeleton, frames[i].name, pointer, diagnostics);
    if (!joint.valid()) continue;
    const JointId parent = skeleton.parent(joint);
    const std::string parentName = parent.valid() ? skeleton.joint(parent).name : std::string();
    const int first = firstOfSix(skeleton, joint);
    if (first < 0 || parentName != frames[i].parent) {
      diagnostics.error(
          pointer,
          "the joint " + quotedName(frames[i].name) +
              (first < 0 ? " lacks some of its six degrees of freedom"
                         : " hangs from " + quotedName(parentName) + ", in the motion from " +
                               quotedName(frames[i].parent)),
          "imported motions need the rig's own joints; run 'fascia flesh' again");
      continue;
    }
    const JointDef& def = skeleton.joint(joint);
    Transform before = Transform{rotationZyx(def.orientation_rad), def.offset_m}.inverse();
    if (parent.valid()) {
      const auto frame = std::find_if(frames.begin(), frames.end(),
                                      [&](const SampledFrame& f) { return f.name == parentName; });
      if (frame != frames.end()) before = before * change(*frame, parent).inverse();
    }
    clip.sampledJoints.push_back(
        {i, static_cast<std::size_t>(first), before, change(frames[i], joint)});
  }
  clip.sampled = std::move(motion);
  return clip;
}

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
  posture.rotations.clear();
  for (std::size_t i = 0; i < posture.values.size(); ++i) {
    posture.values[i] = skeleton.valueDof(static_cast<int>(i)).rest;
  }
  for (const BoundClip::JointTrack& track : clip.joints) {
    const SplineSample sample = track.spline.at(time_s);
    posture.values[static_cast<std::size_t>(track.value)] = sample.value;
    posture.rates[static_cast<std::size_t>(track.value)] = sample.rate;
  }
  if (clip.sampled) sampleFrames(clip, time_s, posture);
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
