#pragma once

#include <cstddef>
#include <string>

#include <fascia/skeleton/skeleton.h>

namespace fascia {

// More joints than any figure with hands and a face; bounds what a hostile file can cost.
inline constexpr std::size_t kMostJoints = 1024;

// Reports every fault of a skeleton; see Skeleton's constructor.
void validateSkeleton(const SkeletonDef& def, const std::string& pointer, Diagnostics& diagnostics);

}  // namespace fascia
