#pragma once

#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/pose/joint_motion.h>
#include <fascia/pose/pose_mesh.h>

namespace fascia {

// Solids of a field that stand around a figure (props, a scene's bodies): those from `first` on.
struct PoseObstacles {
  const DistanceField* field = nullptr;
  std::size_t first = 0;
};

// What of the skin lies inside of obstacles is pressed out onto their surface; the skin around
// gives way with it, less and less over a few rings of the mesh.
class Dents {
 public:
  struct Scratch {
    VectorArray point, normal;
    std::vector<float> distance_m;
    std::vector<std::uint32_t> inside, active;
    std::vector<std::uint8_t> ring;  // per point of the skin: 0 untouched, 1 pressed, 2 … around
    FrameArray shift, next;
  };
  // Positions are relative to `origin_m`.
  static void press(const PoseMesh& mesh, const PoseObstacles& obstacles, const Vec3& origin_m,
                    std::span<Vector4f> position, Scratch& scratch);
};

}  // namespace fascia
