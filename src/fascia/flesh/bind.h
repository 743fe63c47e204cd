#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fascia/flesh/posture_source.h>
#include <fascia/motion/clip.h>

namespace fascia {

// Finds the joints, parameters and morphs that a motion names. Reports every fault of `motion`,
// also those of validateMotion; with errors the result must not be used. Ornaments are rigid: they
// are asked for only to say so. Pointers start with `pointer`, e.g. "/motions/0".
BoundClip bindMotion(const MotionDef& motion, const Figure& figure, const Flesh& ornaments,
                     const std::string& pointer, Diagnostics& diagnostics);

// The frames that a sampled motion means by a joint, in the skeleton's rest posture.
struct SampledFrame {
  std::string name;
  std::string parent;  // whose frame the samples are in; empty: the world
  Transform rest_world;
};

// A motion that came as frames, for the joints and morphs of the figure that it names; `frames` has
// one entry per joint of the motion. A joint must have all six degrees of freedom, in their order.
BoundClip bindSampled(std::shared_ptr<const SampledMotion> motion,
                      std::span<const SampledFrame> frames, const Figure& figure,
                      const std::string& pointer, Diagnostics& diagnostics);

// The posture at a time: rest where no track says otherwise, within the joints' limits.
// Allocation-free after the first call with the same `posture`.
void samplePosture(const BoundClip& clip, const Skeleton& skeleton, double time_s,
                   Posture& posture);

// The animated solid parameters at a time, for Flesh::pose. Replaces what `overrides` held;
// allocation-free after the first call with the same `overrides`.
void sampleParameters(const BoundClip& clip, double time_s,
                      std::vector<Flesh::ParameterOverride>& overrides);

// The weights of all morphs at a time: at rest where no track says otherwise. Allocation-free after
// the first call with the same `out`.
void sampleMorphs(const BoundClip& clip, const Morphs& morphs, double time_s, MorphPose& out);

}  // namespace fascia
