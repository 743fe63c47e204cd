#pragma once

#include <string>

#include <fascia/io/glb_export/gltf_writer.h>
#include <fascia/world/stage_recording.h>

namespace fascia {

// Binary glTF 2.0 (Khronos) of a performance. A body's node has its rigid motion; what is left of
// x = R p(X) is linear in R, so a morph target per coordinate carries it without loss: 12 for an
// affine body, whatever the number of frames. Characters are as in writeGlb(), under a node that
// places them; props stand. Written whole or not at all. Throws Error.
GlbReport writeSceneGlb(const Stage& stage, const StageRecording& recording,
                        const std::string& path);

}  // namespace fascia
