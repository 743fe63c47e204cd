#pragma once

#include <span>

#include <fascia/io/file/byte_stream.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// A rigged model within a binary file, exactly, but with these motions instead of all of its own,
// without its notes, and without its morphs.
void writeRig(const RiggedModel& model, std::span<const SampledMotion> motions, ByteWriter& out);

// Takes it back, and checks all that a RiggedModel promises: files come from strangers.
RiggedModel readRig(ByteReader& in);

// The morphs of a model and of the motions that were written with it; likewise.
void writeRigMorphs(const RiggedModel& model, std::span<const SampledMotion> motions,
                    ByteWriter& out);
void readRigMorphs(ByteReader& in, RiggedModel& model);

}  // namespace fascia
