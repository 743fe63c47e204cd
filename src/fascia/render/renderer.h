#pragma once

#include <memory>
#include <string>

#include <fascia/render/look.h>
#include <fascia/render/pixels.h>
#include <fascia/render/scene.h>

namespace fascia {

// Draws scenes without a window. The same scene gives the same bytes on one machine and driver.
// Keeps what it uploaded: drawing a scene again, with the same drawables in the same places, only
// streams the points that moved. Use from one thread at a time.
class Renderer {
 public:
  static constexpr int kMaxSide = 8192;
  static constexpr long long kMaxPixels = 34'000'000;  // 8K UHD; needs about 1.5 GB

  explicit Renderer(
      Look look = Look::full);  // throws Error with what to install when there is no OpenGL
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Throws Error when the size is absurd or the camera or a mesh is broken.
  Pixels render(const Scene& scene, int width, int height);
  // Reuses the memory of `pixels`: for video.
  void render(const Scene& scene, int width, int height, Pixels& pixels);

  // Seconds that each pass of the last picture took. Costs a little: passes wait for one another.
  struct PassTimes {
    double upload_s = 0, shadow_s = 0, occlusion_s = 0, beauty_s = 0, read_s = 0;
  };
  PassTimes renderMeasured(const Scene& scene, int width, int height, Pixels& pixels);

  std::string description() const;  // of the driver

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascia
