#pragma once

#include <string>

#include <fascia/skeleton/skeleton.h>

namespace fascia {

// Reports every fault of a skeleton; see Skeleton's constructor.
void validateSkeleton(const SkeletonDef& def, const std::string& pointer, Diagnostics& diagnostics);

}  // namespace fascia
