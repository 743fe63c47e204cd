#pragma once

#include <fascia/fitting/part_fit.h>
#include <fascia/rig/joint_meaning.h>

namespace fascia {

// Builds a limb's segment like an anatomist: a slim bone, a condyle at its joint, and three muscle
// bellies around it, one on the side of flexion and two opposite, that swell and shorten (or
// stretch) as the next joint bends. Empty if the part is no limb, or too slim, or if bellies would
// fill it worse than one solid does.
std::vector<NamedSolid> fitMuscles(const FitSetting& setting, const FleshPart& part,
                                   const BoneFrame& frame, const BoneFrame* next,
                                   JointMeaning meaning);

// Fills what one convex solid of a part leaves empty (muzzle, glutes, rib cage) with more of them.
void addFillers(const FitSetting& setting, const FleshPart& part, const BoneFrame& frame,
                std::vector<NamedSolid>& solids);

}  // namespace fascia
