#include <fascia/render/gl/occlusion_pass.h>

#include <cmath>

#include <fascia/render/shaders/sources.h>

namespace fascia::gl {
namespace {

constexpr int kFullSizePixels = 150'000;  // larger pictures are worked on at half size

void drawFullScreen(const VertexArray& noArrays) {
  glBindVertexArray(noArrays.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace

OcclusionPass::OcclusionPass()
    : geometryProgram_(shaders::kMeshVertex, shaders::kGeometryFragment),
      occlusionProgram_(shaders::kFullScreenVertex, shaders::kOcclusionFragment),
      blurProgram_(shaders::kFullScreenVertex, shaders::kBlurFragment) {}

void OcclusionPass::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width, height_ = height;
  allocateTexture(geometry_, width, height, {GL_RGBA32F, GL_RGBA, GL_FLOAT}, GL_NEAREST);
  for (const Texture* texture : {&occlusion_, &blurred_})
    allocateTexture(*texture, width, height, {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE}, GL_NEAREST);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_.id());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  attachTexture(geometryTarget_, GL_COLOR_ATTACHMENT0, geometry_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.id());
  requireComplete("a picture of normals");
  attachTexture(occlusionTarget_, GL_COLOR_ATTACHMENT0, occlusion_);
  requireComplete("a picture of occlusion");
  attachTexture(blurredTarget_, GL_COLOR_ATTACHMENT0, blurred_);
}

void OcclusionPass::drawGeometry(const Frame& frame) {
  glBindFramebuffer(GL_FRAMEBUFFER, geometryTarget_.id());
  glViewport(0, 0, width_, height_);
  glEnable(GL_DEPTH_TEST);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  geometryProgram_.use();
  geometryProgram_.set("clipFromWorld", frame.clipFromWorld);
  geometryProgram_.set("viewFromWorld", frame.viewFromWorld);
  for (const DrawItem& item : frame.items) {
    const bool ground = item.material().kind == Material::Kind::ground;
    if (!ground && !item.casts()) continue;
    geometryProgram_.set("worldFromObject", item.worldFromObject);
    if (!ground) item.drawSeenSides();
    // Floor that nothing darkens is left out: it would be worked on for nothing.
    for (const ScreenBox& part : frame.shadowedFloor) {
      if (!ground) break;
      const ScissorTo darkened(part, width_, height_);
      item.drawSeenSides();
    }
  }
}

void OcclusionPass::blur(const Frame& frame, const Texture& from, const Framebuffer& to,
                         const Eigen::Vector2f& step_uv) {
  glBindFramebuffer(GL_FRAMEBUFFER, to.id());
  blurProgram_.use();
  bindTexture(0, geometry_.id());
  bindTexture(1, from.id());
  blurProgram_.set("geometry", 0);
  blurProgram_.set("source", 1);
  blurProgram_.set("step_uv", step_uv);
  blurProgram_.set("tanHalfFov", frame.tanHalfFov);
  drawFullScreen(noArrays_);
}

void OcclusionPass::draw(const Frame& frame, const ShadowPass& shadow) {
  const bool half = frame.width * frame.height > kFullSizePixels;
  resize(half ? (frame.width + 1) / 2 : frame.width, half ? (frame.height + 1) / 2 : frame.height);
  drawGeometry(frame);

  glDisable(GL_DEPTH_TEST);
  glClearColor(1, 1, 1, 1);
  for (const Framebuffer* target : {&blurredTarget_, &occlusionTarget_}) {
    glBindFramebuffer(GL_FRAMEBUFFER, target->id());
    glClear(GL_COLOR_BUFFER_BIT);
  }
  ScreenBox darkenedPart = frame.subjectOnScreen;
  for (const ScreenBox& part : frame.shadowedFloor) darkenedPart.extend(part);
  const ScissorTo darkened(darkenedPart, width_, height_);
  occlusionProgram_.use();
  bindTexture(0, geometry_.id());
  occlusionProgram_.set("geometry", 0);
  shadow.bind(occlusionProgram_, 1, 2);
  occlusionProgram_.set("worldFromView", frame.worldFromView);
  occlusionProgram_.set("keyDirection", frame.keyDirection);
  occlusionProgram_.set("tanHalfFov", frame.tanHalfFov);
  occlusionProgram_.set("occlusionRadius_m", kOcclusionRadius * frame.subjectRadius_m);
  occlusionProgram_.set("keyRadius", std::tan(frame.scene->studio.key_radius_rad));
  occlusionProgram_.set("thicknessScale_m", frame.thicknessScale_m);
  drawFullScreen(noArrays_);

  const Eigen::Vector2f pixel(1.f / static_cast<float>(width_), 1.f / static_cast<float>(height_));
  blur(frame, occlusion_, blurredTarget_, {pixel.x(), 0});
  blur(frame, blurred_, occlusionTarget_, {0, pixel.y()});
}

void OcclusionPass::bind(Program& program, int geometryUnit, int occlusionUnit) const {
  bindTexture(geometryUnit, geometry_.id());
  bindTexture(occlusionUnit, occlusion_.id());
  program.set("geometry", geometryUnit);
  program.set("occlusion", occlusionUnit);
  program.set("occlusionSize",
              Eigen::Vector2f(static_cast<float>(width_), static_cast<float>(height_)));
}

}  // namespace fascia::gl
