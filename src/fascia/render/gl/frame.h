#pragma once

#include <vector>

#include <fascia/render/gl/gpu_mesh.h>
#include <fascia/render/gl/screen_area.h>
#include <fascia/render/look.h>
#include <fascia/render/scene.h>

namespace fascia::gl {

struct DrawItem {
  const Drawable* drawable;
  const GpuMesh* mesh;
  GLuint texture;  // 0 = none
  Eigen::Matrix4f worldFromObject;
  bool culled;  // front faces hide its back faces, or it has none to be seen

  const Material& material() const { return drawable->material; }
  bool seeThrough() const { return material().opacity < 1; }
  // A see-through skin must not darken the flesh that it is to show.
  bool casts() const {
    return material().kind != Material::Kind::ground &&
           !(material().kind == Material::Kind::skin && seeThrough());
  }
  void drawSeenSides() const;
};

// How far things darken what is next to them, of the subject's radius; larger: darker and vaguer.
inline constexpr float kOcclusionRadius = 0.22f;

// One picture's scene, made ready for the passes.
struct Frame {
  const Scene* scene = nullptr;
  int width = 0, height = 0;
  Box subject;  // everything but the ground
  float subjectRadius_m = 1;
  bool seenFromOutside = true;  // or the camera may see solids from within
  Eigen::Matrix4f viewFromWorld, worldFromView, clipFromWorld;
  Eigen::Vector2f tanHalfFov;
  Eigen::Vector3f keyDirection, fillDirection, rimDirection;  // world, unit, towards the light
  float thicknessScale_m = 0.1f;  // thickness that the occlusion pass resolves
  ScreenBox subjectOnScreen;      // holds all but the ground
  // Parts that hold all the ground that the subject darkens.
  std::vector<ScreenBox> shadowedFloor;
  bool dipsBelowFloor = true;  // the ground may hide a part of the subject
  std::vector<DrawItem> items;
};

// Items are left empty.
Frame prepareFrame(const Scene& scene, int width, int height, Look look);

}  // namespace fascia::gl
