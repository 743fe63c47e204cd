#pragma once

#include <vector>

#include <fascia/geometry/triangle_mesh.h>
#include <fascia/render/gl/screen_area.h>

namespace fascia::gl {

// How far what stands on a floor darkens it.
struct DarkeningReach {
  Eigen::Vector3f light;  // unit, towards the light, above the horizon
  float spread = 0;       // the penumbra's half width, per metre of the shadow's way
  float soft_m = 0;       // … and on top of that
  float near_m = 0;       // what is nearer darkens even where no shadow falls
};

// The parts of a picture in which a subject may darken a floor. Its triangles are asked one by one:
// what their common box could darken is several times as much.
class FloorTiles {
 public:
  FloorTiles(const Eigen::Matrix4f& clipFromWorld, int width, int height,
             const DarkeningReach& reach);
  void add(const TriangleMesh& mesh, const Eigen::Matrix4f& worldFromObject, float floor_m);
  std::vector<ScreenBox> boxes() const;  // do not overlap

 private:
  // A point of the subject, above the floor or below.
  struct Caster {
    float height_m;
    ScreenBox shadow, vicinity;  // of the floor, on the screen
  };
  Caster casterAt(const Eigen::Vector3f& point_world, float floor_m) const;
  ScreenBox aroundFloor(const Eigen::Vector3f& middle_world, float reach_m) const;
  void mark(const ScreenBox& box);

  Eigen::Matrix4f clipFromWorld_;
  DarkeningReach reach_;
  int columns_, rows_;
  Eigen::Vector2f tiles_;        // columns and rows that the picture has, not rounded
  std::vector<char> marked_;     // rows x columns
  std::vector<Caster> casters_;  // of the mesh that is added; kept for its memory
};

}  // namespace fascia::gl
