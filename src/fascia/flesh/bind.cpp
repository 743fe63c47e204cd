#include <fascia/flesh/bind.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/suggest.h>
#include <fascia/flesh/names.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

// Postures and parameters are clamped when played: the person should know that a key is not met.
void warnOutside(const std::vector<Key>& keys, double min, double max, const std::string& pointer,
                 Diagnostics& diagnostics) {
  const auto outside = [&](const Key& key) { return !(key.value >= min && key.value <= max); };
  const auto first = std::ranges::find_if(keys, outside);
  if (first == keys.end()) return;
  const auto others = std::ranges::count_if(keys, outside) - 1;
  diagnostics.warning(
      pointer + "/keys/" + std::to_string(first - keys.begin()),
      "the value " + shortNumber(first->value) + " lies outside [" + shortNumber(min) + ", " +
          shortNumber(max) + "] and will be clamped" +
          (others > 0 ? ", as are " + std::to_string(others) + " more of the track" : ""));
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
  for (std::size_t i = 0; i < track.keys.size(); ++i)
    checkNumber(dofInfo(*dof), track.keys[i].value, entryOf(pointer + "/keys", i), diagnostics);
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

// Index into Morphs; -1 after an error.
int bindMorph(const std::string& name, const Morphs& morphs, const std::string& pointer,
              Diagnostics& diagnostics) {
  const int morph = morphs.find(name);
  if (morph >= 0) return morph;
  NearestName nearest(name);
  for (std::size_t i = 0; i < morphs.size(); ++i) nearest.offer(morphs[i].name);
  diagnostics.error(
      pointer, "unknown morph " + quotedName(name),
      morphs.size() > 0 ? nearest.hint() : "the character has none: they come with a rig's file");
  return -1;
}

void bindSolidTrack(const TrackDef& track, const Figure& figure, const Flesh& ornaments,
                    const std::string& pointer, Diagnostics& diagnostics, double period_s,
                    BoundClip& clip) {
  const SolidId solid = bindSolid(track, figure.flesh, ornaments, pointer, diagnostics);
  if (!solid.valid()) return;
  const Solid& rest = figure.flesh.restSolid(solid);
  const int parameter = resolveParameter(rest, track.channel, pointer + "/parameter", diagnostics);
  if (parameter < 0) return;
  const ParameterInfo& info = rest.parameterInfo(parameter);
  warnOutside(track.keys, info.min, info.max, pointer, diagnostics);
  clip.solids.push_back({solid.value, parameter, KeySpline(track.keys, period_s)});
}

void bindTrack(const TrackDef& track, const Figure& figure, const Flesh& ornaments,
               const std::string& pointer, Diagnostics& diagnostics, double period_s,
               BoundClip& clip) {
  if (track.name.empty()) return;  // reported by validateMotion
  if (track.target == TrackDef::Target::morph) {
    const int morph = bindMorph(track.name, figure.morphs, pointer + "/morph", diagnostics);
    if (morph < 0) return;
    warnOutside(track.keys, -kMostMorphWeight, kMostMorphWeight, pointer, diagnostics);
    clip.morphs.push_back({static_cast<std::size_t>(morph), KeySpline(track.keys, period_s)});
    return;
  }
  if (track.channel.empty()) return;  // as above
  if (track.target == TrackDef::Target::solid) {
    bindSolidTrack(track, figure, ornaments, pointer, diagnostics, period_s, clip);
    return;
  }
  const int value = bindJoint(track, figure.skeleton, pointer, diagnostics);
  if (value >= 0) clip.joints.push_back({value, KeySpline(track.keys, period_s)});
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
    FASCIA_ASSERT(joint.firstValue + 6 <= posture.values.size(),
                  "the clip is bound to this skeleton");
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
                      std::span<const SampledFrame> frames, const Figure& figure,
                      const std::string& pointer, Diagnostics& diagnostics) {
  const Skeleton& skeleton = figure.skeleton;
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
  for (std::size_t i = 0; i < motion->morphs.size(); ++i) {
    const int morph = bindMorph(motion->morphs[i], figure.morphs, pointer, diagnostics);
    if (morph >= 0) clip.sampledMorphs.push_back({i, static_cast<std::size_t>(morph)});
  }
  clip.sampled = std::move(motion);
  return clip;
}

BoundClip bindMotion(const MotionDef& motion, const Figure& figure, const Flesh& ornaments,
                     const std::string& pointer, Diagnostics& diagnostics) {
  validateMotion(motion, pointer, diagnostics);
  BoundClip clip;
  clip.name = motion.name;
  clip.duration_s = playedDuration_s(motion);
  clip.loop = motion.loop;
  for (std::size_t i = 0; i < std::min(motion.tracks.size(), kMostTracks); ++i) {
    bindTrack(motion.tracks[i], figure, ornaments, pointer + "/tracks/" + std::to_string(i),
              diagnostics, clip.loop ? clip.duration_s : 0, clip);
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
    FASCIA_ASSERT(track.value >= 0 && static_cast<std::size_t>(track.value) < posture.values.size(),
                  "the clip is bound to this skeleton");
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

void sampleMorphs(const BoundClip& clip, const Morphs& morphs, double time_s, MorphPose& out) {
  morphs.rest(out);
  for (const BoundClip::MorphTrack& track : clip.morphs) {
    FASCIA_ASSERT(track.morph < morphs.size(), "the clip is bound to these morphs");
    const SplineSample sample = track.spline.at(time_s);
    out.weights[track.morph] = sample.value;
    out.rates[track.morph] = sample.rate;
  }
  const bool still = !clip.loop && (time_s <= 0 || time_s >= clip.duration_s);
  for (const BoundClip::SampledMorph& track : clip.sampledMorphs) {
    FASCIA_ASSERT(track.morph < morphs.size(), "the clip is bound to these morphs");
    const auto at = [&](double t_s) { return sampleWeight(*clip.sampled, track.sample, t_s); };
    out.weights[track.morph] = at(time_s);
    if (!still)
      out.rates[track.morph] =
          (at(time_s + kRateSpan_s) - at(time_s - kRateSpan_s)) / (2 * kRateSpan_s);
  }
  morphs.admit(out);
}

}  // namespace fascia
