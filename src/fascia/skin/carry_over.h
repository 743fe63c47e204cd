#pragma once

#include <fascia/skin/skin.h>

namespace fascia {

// The state of a skin as one of the skin that it was edited into, in the pose that this has now.
// Points keep their places and velocities (resampled to another grid, reordered on a mesh), and
// strands begin where the pose puts their inner ends. An edit that moves flesh far takes its skin
// along. Where points do not correspond, all starts where the pose puts it.
SkinState carryOver(const Skin& from, SkinState state, const Skin& to, const SkinPose& pose);

// Whether a state has the sizes of this skin's; nullptr, or what does not fit.
const char* misfit(const Skin& skin, const SkinState& state);

}  // namespace fascia
