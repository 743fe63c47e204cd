#include <fascia/render/gl/shadow_pass.h>

#include <fascia/render/shaders/sources.h>

namespace fascia::gl {
namespace {

void setFilter(const Sampler& sampler, GLint filter) {
  for (GLenum which : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glSamplerParameteri(sampler.id(), which, filter);
  for (GLenum which : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glSamplerParameteri(sampler.id(), which, GL_CLAMP_TO_EDGE);
}

}  // namespace

ShadowPass::ShadowPass(int size)
    : program_(shaders::kMeshVertex, shaders::kDepthFragment), size_(size) {
  allocateTexture(depth_, size_, size_, {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT},
                  GL_NEAREST);
  attachTexture(framebuffer_, GL_DEPTH_ATTACHMENT, depth_);
  const GLenum none = GL_NONE;
  glDrawBuffers(1, &none);
  glReadBuffer(GL_NONE);
  requireComplete("a shadow map");
  setFilter(plain_, GL_NEAREST);
  setFilter(compare_, GL_LINEAR);
  glSamplerParameteri(compare_.id(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glSamplerParameteri(compare_.id(), GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
}

void ShadowPass::fit(const Frame& frame) {
  const Eigen::Vector3f back = frame.keyDirection;
  const Eigen::Vector3f pole =
      std::abs(back.y()) < 0.99f ? Eigen::Vector3f::UnitY() : Eigen::Vector3f::UnitZ();
  const Eigen::Vector3f right = pole.cross(back).normalized(), up = back.cross(right);
  const Eigen::Vector3f center = frame.subject.center().cast<float>();
  const float radius_m = 1.05f * frame.subjectRadius_m;
  extent_m_ = 2 * radius_m;
  range_m_ = 8 * radius_m;  // the floor behind the subject, along a low light
  // c = (x·right, x·up, depth from the near plane) scaled to [0, 1]
  Eigen::Matrix4f m = Eigen::Matrix4f::Identity();
  m.block<1, 3>(0, 0) = right.transpose() / extent_m_;
  m.block<1, 3>(1, 0) = up.transpose() / extent_m_;
  m.block<1, 3>(2, 0) = -back.transpose() / range_m_;
  m.block<3, 1>(0, 3) =
      Eigen::Vector3f(0.5f, 0.5f, radius_m / range_m_) - m.block<3, 3>(0, 0) * center;
  shadowFromWorld_ = m;
}

void ShadowPass::draw(const Frame& frame) {
  fit(frame);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, size_, size_);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glClear(GL_DEPTH_BUFFER_BIT);
  Eigen::Matrix4f clipFromShadow = Eigen::Matrix4f::Identity();
  clipFromShadow.diagonal().head<3>().setConstant(2);
  clipFromShadow.block<3, 1>(0, 3).setConstant(-1);
  program_.use();
  program_.set("clipFromWorld", Eigen::Matrix4f(clipFromShadow * shadowFromWorld_));
  for (const DrawItem& item : frame.items) {
    if (!item.casts()) continue;
    program_.set("worldFromObject", item.worldFromObject);
    item.drawSeenSides();
  }
}

void ShadowPass::bind(Program& program, int depthUnit, int compareUnit) const {
  bindTexture(depthUnit, depth_.id(), plain_.id());
  bindTexture(compareUnit, depth_.id(), compare_.id());
  program.set("shadowDepth", depthUnit);
  program.set("shadowCompare", compareUnit);
  program.set("shadowFromWorld", shadowFromWorld_);
  program.set("shadowExtent_m", extent_m_);
  program.set("shadowDepth_m", range_m_);
  program.set("shadowTexel_m", extent_m_ / static_cast<float>(size_));
}

}  // namespace fascia::gl
