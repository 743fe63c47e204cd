#pragma once

#include <fascia/io/documents/plain_codecs.h>
#include <fascia/material/body_def.h>

namespace fascia {

// "affine", "quadratic", {"polynomial": 3} or {"lattice": [3, 2, 2]}; in two dimensions a lattice's
// third number may be left out.
CodecPtr<BodyBasisDef> bodyBasisCodec();

}  // namespace fascia
