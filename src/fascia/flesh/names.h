#pragma once

#include <string>

#include <fascia/field/solid.h>
#include <fascia/skeleton/skeleton.h>

namespace fascia {

// Names that drivers and tracks use, looked up; what is not there is reported at `pointer`, with
// the nearest known name as a hint.
JointId resolveJoint(const Skeleton& skeleton, const std::string& name, const std::string& pointer,
                     Diagnostics& diagnostics);  // invalid if there is none
int resolveDof(const Skeleton& skeleton, JointId joint, Dof dof, const std::string& pointer,
               Diagnostics& diagnostics);  // index into Posture::values; -1 if the joint lacks it
int resolveParameter(const Solid& solid, const std::string& path, const std::string& pointer,
                     Diagnostics& diagnostics);  // -1 if there is none

}  // namespace fascia
