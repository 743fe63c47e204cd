#pragma once

#include <memory>
#include <vector>

#include <fascia/flesh/flesh.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>
#include <fascia/render/camera.h>
#include <fascia/render/pixels.h>

namespace fascia {

// Colours a person gives are sRGB in [0, 1]; light intensities are linear factors.
using Rgb = Eigen::Vector3f;
inline Rgb rgb(const Color& color) {
  return {color.r, color.g, color.b};
}

struct Material {
  enum class Kind {
    skin,    // subsurface scattering, two specular lobes
    muscle,  // fibres along the solid's axis, moist
    bone,    // ivory
    plain,   // an ordinary dielectric: eyes, beaks, props
    ground   // takes shadows and fades into the background
  };
  Kind kind = Kind::plain;
  Rgb color{0.8f, 0.8f, 0.8f};            // multiplies the texture where there is one
  std::shared_ptr<const Pixels> texture;  // may be null; held while the renderer caches it
  bool tiled = false;                     // the texture repeats upwards too, not only around
  float roughness = 0.5f;                 // [0.03, 1]
  float metallic = 0;                     // plain: [0, 1], mirrors in its own colour
  float wrap = 0;                         // plain: [0, 1], light creeps around: fur, cloth
  float scatter_m = 0.01f;    // skin: how far light travels inside; 1 % of the height looks soft
  float translucency = 0.6f;  // skin: [0, 1], light through thin parts
  float opacity = 1;          // [0, 1]; below 1 the rim stays denser, so that the outline reads
  float xray = 0;             // [0, 1] how strongly it shows through what hides it: bones in flesh
};

struct Drawable {
  TriangleMesh mesh;  // normals may be empty: then computed
  // Muscle only: per vertex the solid's coordinates scaled to [-1, 1], fibres along z. May be
  // empty.
  std::vector<Eigen::Vector3f> fibre_coordinates;
  Transform world;  // from the mesh's space
  Material material;
};

struct DirectionalLight {
  Vec3 direction{0, 1, 0};  // towards the light, any length
  Rgb color{1, 1, 1};       // linear
  float intensity = 1;
};

// A photographer's studio: a soft key light with a shadow, a fill, a rim, and the room itself.
// Directions are turned about y by azimuth_rad, so that the lights can follow the camera's side.
struct Studio {
  DirectionalLight key{{0.80, 0.92, 0.62}, {1.0f, 0.95f, 0.88f}, 2.7f};
  DirectionalLight fill{{-0.95, 0.35, 0.75}, {0.80f, 0.90f, 1.0f}, 0.55f};
  DirectionalLight rim{{-0.55, 0.55, -1.0}, {0.90f, 0.95f, 1.0f}, 1.5f};
  Rgb sky{0.70f, 0.78f, 0.88f};      // linear radiance from above
  Rgb horizon{0.60f, 0.62f, 0.64f};  // … from the sides
  Rgb floor{0.36f, 0.33f, 0.30f};    // … from below
  float key_radius_rad = 0.10f;      // half the angle the key light fills: softness of shadows
  float azimuth_rad = 0;
  float exposure = 0.5f;
};

struct Background {
  Rgb top{0.60f, 0.65f, 0.70f};
  Rgb bottom{0.83f, 0.84f, 0.845f};
  float vignette = 0.22f;  // [0, 1] darkening of the corners
};

// Everything in one picture; plain data.
struct Scene {
  Camera camera;
  Studio studio;
  Background background;
  std::vector<Drawable> drawables;
};

Box worldBounds(const Drawable& drawable);
Box worldBounds(const Scene& scene);  // without the ground; ignores points that are not finite

// A round floor centred below `bounds`, level with its lowest point (or `height_m` if given).
Drawable groundDisc(const Box& bounds);
Drawable groundDisc(const Box& bounds, double height_m);

}  // namespace fascia
