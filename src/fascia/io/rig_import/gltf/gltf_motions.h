#pragma once

#include <fascia/io/rig_import/gltf/gltf_rig.h>

namespace fascia {

// Plays every animation on the whole tree of nodes and keeps what it does to the joints: rigid
// frames at a constant rate, in the model's `motions`.
void readGltfMotions(const GltfDocument& document, const GltfScene& scene, const GltfRig& rig,
                     RiggedModel& model);

}  // namespace fascia
