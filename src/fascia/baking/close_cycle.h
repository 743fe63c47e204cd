#pragma once

#include <span>

#include <fascia/baking/skinning_decomposition.h>

namespace fascia {

// Makes a recorded cycle end with the surface that it begins with, `travel_m` away: what is left of
// the difference is taken out over the last part, growing smoothly from nothing, and turned along
// with each point's joint. Returns the largest distance that there was between the ends.
//
// bones: per frame, per joint, the motion from rest; carrier: per point, the joint to turn with.
double closeCycle(PointFrames& frames, const BoneFrames& bones,
                  std::span<const std::uint32_t> carrier, const Vec3& travel_m);

}  // namespace fascia
