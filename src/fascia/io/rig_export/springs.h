#pragma once

#include <string>
#include <vector>

#include <fascia/io/rig_export/rig_source.h>

namespace fascia {

// Takes a VRM's swinging chains out, if that is asked for, of which a joint moves the skin. Returns
// what a person is told of those that stay or go.
std::vector<std::string> settleSprings(RigSource& source, const RigFileOptions& options);

}  // namespace fascia
