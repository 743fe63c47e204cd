#include <fascia/render/gl/beauty_pass.h>

#include <algorithm>

#include <fascia/render/edge_filter.h>
#include <fascia/render/shaders/sources.h>

namespace fascia::gl {
namespace {

constexpr int kSamples = 4;  // per pixel; 8 costs a software rasteriser half as much again

// Rows from the top.
PixelBox pixelsOf(const ScreenBox& box, int width, int height) {
  const Eigen::Vector2f size(static_cast<float>(width), static_cast<float>(height));
  const Eigen::Vector2f low = box.min().cwiseProduct(size), high = box.max().cwiseProduct(size);
  constexpr float kMargin = 2;  // pixels: an outline's other side
  return {static_cast<int>(low.x() - kMargin), static_cast<int>(size.y() - high.y() - kMargin),
          static_cast<int>(high.x() + kMargin), static_cast<int>(size.y() - low.y() + kMargin)};
}

}  // namespace

BeautyPass::BeautyPass(Look look)
    : samples_(look == Look::fast ? 0 : kSamples),
      lit_(look),
      depthProgram_(shaders::kMeshVertex, shaders::kDepthFragment),
      layerProgram_(shaders::kFullScreenVertex, shaders::kLayerFragment) {}

void BeautyPass::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width, height_ = height;
  allocateTexture(layer_, width, height, {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE}, GL_NEAREST);
  attachTexture(resolved_, GL_COLOR_ATTACHMENT0, layer_);
  requireComplete("a layer of a picture");
  glBindRenderbuffer(GL_RENDERBUFFER, depth_.id());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, GL_DEPTH24_STENCIL8, width, height);
  if (samples_ == 0) {
    attachTexture(target_, GL_COLOR_ATTACHMENT0, layer_);
  } else {
    glBindRenderbuffer(GL_RENDERBUFFER, color_.id());
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, GL_RGBA8, width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_.id());
  }
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                            depth_.id());
  requireComplete("an anti-aliased picture");
}

void BeautyPass::drawOpaque(const Frame& frame, const LightPasses& light,
                            std::initializer_list<Material::Kind> kinds) {
  for (const auto kind : kinds)
    for (const DrawItem& item : frame.items) {
      if (item.seeThrough() || item.material().kind != kind) continue;
      if (item.culled) glEnable(GL_CULL_FACE);
      lit_.draw(frame, light, item);
      glDisable(GL_CULL_FACE);
    }
}

// What shows through is blended once per sample, marked in the stencil: overlapping bones would
// otherwise add up.
void BeautyPass::drawHidden(const Frame& frame, const LightPasses& light) {
  glEnable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);
  glEnable(GL_STENCIL_TEST);
  glStencilFunc(GL_EQUAL, 0, 0xff);
  glStencilOp(GL_KEEP, GL_KEEP, GL_INCR);
  for (const DrawItem& item : frame.items)
    if (item.material().xray > 0) lit_.draw(frame, light, item, LitPrograms::Part::hidden);
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
void BeautyPass::drawSeeThrough(const Frame& frame, const LightPasses& light, Material::Kind kind) {
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
      if (isLayer(item)) lit_.draw(frame, light, item);
    glDepthMask(GL_TRUE);
  }
  glCullFace(GL_BACK);
  drawDepth(frame, kind);
  glDepthFunc(GL_LEQUAL);
  for (const DrawItem& item : frame.items)
    if (isLayer(item)) lit_.draw(frame, light, item);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
}

// Where the floor is nearer, the backdrop shows.
void BeautyPass::cutGround(const Frame& frame) {
  if (!frame.dipsBelowFloor) return;
  depthProgram_.use();
  depthProgram_.set("clipFromWorld", frame.clipFromWorld);
  for (const DrawItem& item : frame.items)
    if (item.material().kind == Material::Kind::ground && !item.seeThrough()) {
      depthProgram_.set("worldFromObject", item.worldFromObject);
      item.drawSeenSides();
    }
}

void BeautyPass::drawSubject(const Frame& frame, const LightPasses& light) {
  glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
  glEnable(GL_DEPTH_TEST);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  using Kind = Material::Kind;
  drawOpaque(frame, light, {Kind::skin, Kind::muscle, Kind::bone});
  drawHidden(frame, light);  // through those, but not through eyes or the floor
  drawOpaque(frame, light, {Kind::plain});
  cutGround(frame);
  for (const auto kind : {Kind::bone, Kind::muscle, Kind::plain, Kind::skin})
    drawSeeThrough(frame, light, kind);
}

void BeautyPass::resolve() {
  if (samples_ == 0) return;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.id());
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void BeautyPass::layOverBackdrop() {
  glBindFramebuffer(GL_FRAMEBUFFER, backdrop_.picture().id());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // the layer's colours are multiplied by its alpha
  layerProgram_.use();
  bindTexture(0, layer_.id());
  layerProgram_.set("layer", 0);
  glBindVertexArray(noArrays_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
}

void BeautyPass::draw(const Frame& frame, const LightPasses& light) {
  resize(frame.width, frame.height);
  backdrop_.draw(frame, light, lit_);
  const ScissorTo subject(frame.subjectOnScreen, width_, height_);
  subject_ = frame.subjectOnScreen;
  drawSubject(frame, light);
  resolve();
  layOverBackdrop();
}

void BeautyPass::read(Pixels& pixels) const {
  const std::size_t row = static_cast<std::size_t>(width_) * 4;
  pixels.width = width_, pixels.height = height_;
  pixels.rgba.resize(row * static_cast<std::size_t>(height_));
  glBindFramebuffer(GL_FRAMEBUFFER, backdrop_.picture().id());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.rgba.data());
  // OpenGL's rows start at the bottom.
  for (std::size_t top = 0, bottom = static_cast<std::size_t>(height_) - 1; top < bottom;
       ++top, --bottom)
    std::swap_ranges(pixels.rgba.begin() + static_cast<std::ptrdiff_t>(top * row),
                     pixels.rgba.begin() + static_cast<std::ptrdiff_t>((top + 1) * row),
                     pixels.rgba.begin() + static_cast<std::ptrdiff_t>(bottom * row));
  if (samples_ == 0) smoothEdges(pixels, pixelsOf(subject_, width_, height_));
}

}  // namespace fascia::gl
