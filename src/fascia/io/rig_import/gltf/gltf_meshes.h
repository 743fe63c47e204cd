#pragma once

#include <fascia/io/rig_import/gltf/gltf_rig.h>

namespace fascia {

// Reads the primitives of all meshes that are shown into the model: vertices, drawnTriangles, parts
// and, through buildSimulatedSurface, the simulated surface. Everything is placed in the bind pose.
void readGltfMeshes(const GltfDocument& document, const GltfScene& scene, const GltfRig& rig,
                    RiggedModel& model);

}  // namespace fascia
