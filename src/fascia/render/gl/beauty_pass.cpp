#include <fascia/render/gl/beauty_pass.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <fascia/render/lookups.h>
#include <fascia/render/mip_levels.h>
#include <fascia/render/shaders/sources.h>

namespace fascia::gl {
namespace {

constexpr int kSamples = 4;  // per pixel; 8 costs a software rasteriser half as much again
constexpr int kLookupWidth = 128, kLookupHeight = 32, kNoiseSide = 512;

enum Unit { kColorUnit, kGeometryUnit, kOcclusionUnit, kLookupUnit, kNoiseUnit };

Eigen::Vector3f linearFromSrgb(const Rgb& c) {
  return c.unaryExpr([](float s) {
    s = std::clamp(s, 0.f, 1.f);
    return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
  });
}

void setStudio(Program& program, const Frame& frame) {
  const Studio& studio = frame.scene->studio;
  program.set("keyDirection", frame.keyDirection);
  program.set("fillDirection", frame.fillDirection);
  program.set("rimDirection", frame.rimDirection);
  program.set("keyColor", Eigen::Vector3f(studio.key.color * studio.key.intensity));
  program.set("fillColor", Eigen::Vector3f(studio.fill.color * studio.fill.intensity));
  program.set("rimColor", Eigen::Vector3f(studio.rim.color * studio.rim.intensity));
  program.set("skyColor", studio.sky);
  program.set("horizonColor", studio.horizon);
  program.set("floorColor", studio.floor);
  program.set("exposure", studio.exposure);
  program.set("backgroundTop", linearFromSrgb(frame.scene->background.top));
  program.set("backgroundBottom", linearFromSrgb(frame.scene->background.bottom));
  program.set("vignette", frame.scene->background.vignette);
}

void setMaterial(Program& program, const DrawItem& item) {
  const Material& material = item.material();
  program.set("baseColor", linearFromSrgb(material.color));
  program.set("roughness", std::clamp(material.roughness, 0.03f, 1.f));
  program.set("scatter_m", std::max(material.scatter_m, 0.f));
  program.set("translucency", std::clamp(material.translucency, 0.f, 1.f));
  program.set("opacity", std::clamp(material.opacity, 0.f, 1.f));
  program.set("metallic", std::clamp(material.metallic, 0.f, 1.f));
  program.set("wrap", std::clamp(material.wrap, 0.f, 1.f));
  program.set("textured", item.texture != 0 ? 1 : 0);
}

void uploadNoise(const Texture& texture) {
  const TextureFormat format{GL_R8, GL_RED, GL_UNSIGNED_BYTE};
  MipLevel mip{kNoiseSide, kNoiseSide, tileableNoise(kNoiseSide)};
  allocateTexture(texture, kNoiseSide, kNoiseSide, format, GL_LINEAR, mip.texels.data());
  for (int level = 1; mip.width > 1; ++level) {
    mip = halved(mip.texels.data(), mip.width, mip.height, 1);
    uploadLevel(texture, level, mip.width, mip.height, format, mip.texels.data());
  }
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  for (GLenum which : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, which, GL_REPEAT);
}

}  // namespace

BeautyPass::BeautyPass()
    : backgroundProgram_(shaders::kFullScreenVertex,
                         std::string(shaders::kStudio) + shaders::kBackgroundFragment),
      depthProgram_(shaders::kMeshVertex, shaders::kDepthFragment) {
  const auto lookup = scatterLookup(kLookupWidth, kLookupHeight);
  allocateTexture(scatterLookup_, kLookupWidth, kLookupHeight, {GL_RGB16F, GL_RGB, GL_FLOAT},
                  GL_LINEAR, lookup.data());
  uploadNoise(noise_);
}

void BeautyPass::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width, height_ = height;
  glBindRenderbuffer(GL_RENDERBUFFER, color_.id());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, kSamples, GL_RGBA8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_.id());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, kSamples, GL_DEPTH24_STENCIL8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, resolvedColor_.id());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_.id());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                            depth_.id());
  requireComplete("an anti-aliased picture");
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_.id());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                            resolvedColor_.id());
  requireComplete("a picture");
}

Program& BeautyPass::litProgram(Material::Kind kind) {
  constexpr std::array<const char*, 5> defines{"#define SKIN\n", "#define MUSCLE\n",
                                               "#define BONE\n", "#define PLAIN\n",
                                               "#define GROUND\n"};
  const auto index = static_cast<std::size_t>(kind);
  auto& program = litPrograms_[index];
  if (!program)
    program = std::make_unique<Program>(
        shaders::kMeshVertex,
        std::string(shaders::kStudio) + shaders::kSurface + shaders::kMaterial, defines[index]);
  return *program;
}

void BeautyPass::drawBackground(const Frame& frame) {
  glDisable(GL_DEPTH_TEST);
  backgroundProgram_.use();
  setStudio(backgroundProgram_, frame);
  glBindVertexArray(noArrays_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
}

void BeautyPass::drawLit(const Frame& frame, const OcclusionPass& occlusion, const DrawItem& item,
                         bool hidden) {
  Program& program = litProgram(item.material().kind);
  program.use();
  setStudio(program, frame);
  setMaterial(program, item);
  bindTexture(kColorUnit, item.texture);
  if (item.texture != 0)
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T,
                    item.material().tiled ? GL_REPEAT : GL_CLAMP_TO_EDGE);
  bindTexture(kLookupUnit, scatterLookup_.id());
  bindTexture(kNoiseUnit, noise_.id());
  program.set("colorTexture", kColorUnit);
  program.set("scatterLookup", kLookupUnit);
  program.set("noiseTexture", kNoiseUnit);
  occlusion.bind(program, kGeometryUnit, kOcclusionUnit);
  const bool occluded = item.casts() || item.material().kind == Material::Kind::ground;
  program.set("unoccluded", occluded && !hidden ? 0.f : 1.f);
  program.set("ghost", hidden ? std::clamp(item.material().xray, 0.f, 1.f) : 0.f);
  program.set("thicknessScale_m", frame.thicknessScale_m);
  program.set("targetSize",
              Eigen::Vector2f(static_cast<float>(width_), static_cast<float>(height_)));
  program.set("eye_world", Eigen::Vector3f(frame.scene->camera.eye_m.cast<float>()));
  program.set("viewFromWorld", frame.viewFromWorld);
  program.set("clipFromWorld", frame.clipFromWorld);
  program.set("worldFromObject", item.worldFromObject);
  item.mesh->draw();
}

void BeautyPass::drawOpaque(const Frame& frame, const OcclusionPass& occlusion,
                            std::initializer_list<Material::Kind> kinds) {
  for (const auto kind : kinds)
    for (const DrawItem& item : frame.items) {
      if (item.seeThrough() || item.material().kind != kind) continue;
      if (item.culled) glEnable(GL_CULL_FACE);
      drawLit(frame, occlusion, item);
      glDisable(GL_CULL_FACE);
    }
}

// What shows through is blended once per sample, marked in the stencil: overlapping bones would
// otherwise add up.
void BeautyPass::drawHidden(const Frame& frame, const OcclusionPass& occlusion) {
  glEnable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);
  glEnable(GL_STENCIL_TEST);
  glStencilFunc(GL_EQUAL, 0, 0xff);
  glStencilOp(GL_KEEP, GL_KEEP, GL_INCR);
  for (const DrawItem& item : frame.items)
    if (item.material().xray > 0) drawLit(frame, occlusion, item, true);
  glDisable(GL_STENCIL_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
}

void BeautyPass::drawDepth(const Frame& frame, Material::Kind kind) {
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  depthProgram_.use();
  depthProgram_.set("clipFromWorld", frame.clipFromWorld);
  for (const DrawItem& item : frame.items)
    if (item.seeThrough() && item.material().kind == kind) {
      depthProgram_.set("worldFromObject", item.worldFromObject);
      item.mesh->draw();
    }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

// The skin's back faces, then only the nearest front faces, found by a depth pass before:
// overlapping limbs would otherwise add up in the order in which their triangles happen to come.
void BeautyPass::drawSeeThrough(const Frame& frame, const OcclusionPass& occlusion,
                                Material::Kind kind) {
  const auto isLayer = [kind](const DrawItem& item) {
    return item.seeThrough() && item.material().kind == kind;
  };
  if (std::none_of(frame.items.begin(), frame.items.end(), isLayer)) return;
  glEnable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  if (kind == Material::Kind::skin) {  // the far side of a muscle would only hide the bones
    glDepthMask(GL_FALSE);
    glCullFace(GL_FRONT);
    for (const DrawItem& item : frame.items)
      if (isLayer(item)) drawLit(frame, occlusion, item);
    glDepthMask(GL_TRUE);
  }
  glCullFace(GL_BACK);
  drawDepth(frame, kind);
  glDepthFunc(GL_LEQUAL);
  for (const DrawItem& item : frame.items)
    if (isLayer(item)) drawLit(frame, occlusion, item);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
}

void BeautyPass::draw(const Frame& frame, const OcclusionPass& occlusion) {
  resize(frame.width, frame.height);
  glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
  glViewport(0, 0, width_, height_);
  glClear(GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  drawBackground(frame);
  using Kind = Material::Kind;
  drawOpaque(frame, occlusion, {Kind::skin, Kind::muscle, Kind::bone});
  drawHidden(frame, occlusion);  // through those, but not through eyes or the floor
  // The floor last: most of it is hidden behind what stands on it.
  drawOpaque(frame, occlusion, {Kind::plain, Kind::ground});
  for (const auto kind :
       {Material::Kind::bone, Material::Kind::muscle, Material::Kind::plain, Material::Kind::skin})
    drawSeeThrough(frame, occlusion, kind);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.id());
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void BeautyPass::read(Pixels& pixels) const {
  const std::size_t row = static_cast<std::size_t>(width_) * 4;
  pixels.width = width_, pixels.height = height_;
  pixels.rgba.resize(row * static_cast<std::size_t>(height_));
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_.id());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.rgba.data());
  // OpenGL's rows start at the bottom.
  for (std::size_t top = 0, bottom = static_cast<std::size_t>(height_) - 1; top < bottom;
       ++top, --bottom)
    std::swap_ranges(pixels.rgba.begin() + static_cast<std::ptrdiff_t>(top * row),
                     pixels.rgba.begin() + static_cast<std::ptrdiff_t>((top + 1) * row),
                     pixels.rgba.begin() + static_cast<std::ptrdiff_t>(bottom * row));
}

}  // namespace fascia::gl
