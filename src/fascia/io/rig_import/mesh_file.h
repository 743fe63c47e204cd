#pragma once

#include <string>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// The surface of a .glb or .gltf, all meshes of its scene as one, in metres: vertices that the file
// cuts along seams are joined. A rigged one is in its bind pose. Throws Error (file, JSON pointer).
TriangleMesh readMeshFile(const std::string& path);

}  // namespace fascia
