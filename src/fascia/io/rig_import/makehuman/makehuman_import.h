#pragma once

#include <string>

#include <fascia/io/rig_model/rig_import_options.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// MakeHuman's (and MPFB's) base mesh with one of its rigs: body, eyes, teeth and tongue, without
// the helper geometry that clothes are fitted to. In metres, feet on y = 0.

// Whether a path is one that readMakeHuman takes: a rig (rig.NAME.json, NAME.mhskel) with base.obj
// beside it or one folder up, or a base.obj with rigs/ beside it. Looks at names only.
bool isMakeHuman(const std::string& path);

// With base.obj the rig with CMU's joint names is taken if it is there: most motion capture fits
// it. Throws Error.
RiggedModel readMakeHuman(const std::string& path, const RigImportOptions& options = {});

}  // namespace fascia
