#pragma once

#include <string_view>

#include <fascia/io/file/byte_stream.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// A rigged model within a binary file, exactly. Of its motions only the one of this name is kept.
void writeRig(const RiggedModel& model, std::string_view motion, ByteWriter& out);

// Takes it back, and checks all that a RiggedModel promises: files come from strangers.
RiggedModel readRig(ByteReader& in);

}  // namespace fascia
