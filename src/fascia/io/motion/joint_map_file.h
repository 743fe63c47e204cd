#pragma once

#include <string>
#include <string_view>

#include <fascia/rig/joint_map.h>

namespace fascia {

// A joint map as a person gives it: a JSON object {"source": "target"}, null for what shall drive
// nothing, or lines "source = target" (see parseJointMap). Throws Error with the line.
JointMap readJointMap(const std::string& path);
JointMap jointMapOf(std::string_view text, const std::string& file);

}  // namespace fascia
