#include <fascia/render/renderer.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

#include <fascia/base/error.h>
#include <fascia/render/gl/beauty_pass.h>
#include <fascia/render/gl/texture_cache.h>
#include <fascia/render/gl_context.h>

namespace fascia {
namespace {

constexpr int kShadowSide = 2048;  // texels; smaller: stairs in the shadows of thin limbs
constexpr int kFastShadowSide = 1024;

void requireDrawable(const Scene& scene, int width, int height) {
  const bool sized = width >= 1 && height >= 1 && width <= Renderer::kMaxSide &&
                     height <= Renderer::kMaxSide &&
                     static_cast<long long>(width) * height <= Renderer::kMaxPixels;
  if (!sized) {
    Issue issue;
    issue.message = "render: found a size of " + std::to_string(width) + "x" +
                    std::to_string(height) + ", expected 1 to " +
                    std::to_string(Renderer::kMaxSide) + " on a side and at most " +
                    std::to_string(Renderer::kMaxPixels) + " pixels";
    issue.hint = "1280x720 and 1920x1080 are common";
    throw Error(issue);
  }
  const Camera& c = scene.camera;
  const bool seeing = c.eye_m.allFinite() && c.target_m.allFinite() && c.up.allFinite() &&
                      (c.eye_m - c.target_m).cross(c.up).norm() > 0 && c.vertical_fov_rad > 0 &&
                      c.vertical_fov_rad < kPi;
  if (!seeing) throw Error("render: the camera has no direction, no up or no field of view");
}

}  // namespace

struct Renderer::Impl {
  Look look;
  GlContext context;  // first: everything below needs it until it is gone
  gl::ShadowPass shadow;
  std::optional<gl::OcclusionPass> occlusion;  // none in the fast look
  gl::BeautyPass beauty;
  gl::TextureCache textures;
  std::vector<std::unique_ptr<gl::GpuMesh>> meshes;  // by place in the scene

  explicit Impl(Look wanted)
      : look(wanted), shadow(look == Look::fast ? kFastShadowSide : kShadowSide), beauty(look) {
    if (look == Look::full) occlusion.emplace();
  }
  ~Impl() { context.makeCurrent(); }

  void uploadItems(const Scene& scene, gl::Frame& frame) {
    if (meshes.size() > scene.drawables.size()) meshes.resize(scene.drawables.size());
    while (meshes.size() < scene.drawables.size())
      meshes.push_back(std::make_unique<gl::GpuMesh>());
    for (std::size_t i = 0; i < scene.drawables.size(); ++i) {
      const Drawable& drawable = scene.drawables[i];
      meshes[i]->update(drawable);
      Eigen::Matrix4f world = Eigen::Matrix4f::Identity();
      world.block<3, 3>(0, 0) = drawable.world.rotation.cast<float>();
      world.block<3, 1>(0, 3) = drawable.world.translation_m.cast<float>();
      const bool ground = drawable.material.kind == Material::Kind::ground;
      frame.items.push_back({&drawable, meshes[i].get(), textures.find(drawable.material.texture),
                             world, ground || (frame.seenFromOutside && meshes[i]->closed())});
    }
    textures.dropUnused();
  }

  // `run` runs a pass, and may note its time.
  template <class Run>
  PassTimes render(const Scene& scene, int width, int height, Pixels& pixels, const Run& run) {
    requireDrawable(scene, width, height);
    context.makeCurrent();
    gl::Frame frame = gl::prepareFrame(scene, width, height, look);
    PassTimes times;
    run(times.upload_s, [&] { uploadItems(scene, frame); });
    run(times.shadow_s, [&] { shadow.draw(frame); });
    if (occlusion) run(times.occlusion_s, [&] { occlusion->draw(frame, shadow); });
    run(times.beauty_s, [&] { beauty.draw(frame, {shadow, occlusion ? &*occlusion : nullptr}); });
    run(times.read_s, [&] { beauty.read(pixels); });
    return times;
  }
};

Renderer::Renderer(Look look) : impl_(std::make_unique<Impl>(look)) {}
Renderer::~Renderer() = default;

Pixels Renderer::render(const Scene& scene, int width, int height) {
  Pixels pixels;
  render(scene, width, height, pixels);
  return pixels;
}

void Renderer::render(const Scene& scene, int width, int height, Pixels& pixels) {
  impl_->render(scene, width, height, pixels, [](double&, const auto& pass) { pass(); });
}

Renderer::PassTimes Renderer::renderMeasured(const Scene& scene, int width, int height,
                                             Pixels& pixels) {
  using Clock = std::chrono::steady_clock;
  return impl_->render(scene, width, height, pixels, [](double& time_s, const auto& pass) {
    const Clock::time_point begin = Clock::now();
    pass();
    glFinish();
    time_s = std::chrono::duration<double>(Clock::now() - begin).count();
  });
}

std::string Renderer::description() const {
  return impl_->context.description();
}

}  // namespace fascia
