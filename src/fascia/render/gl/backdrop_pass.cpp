#include <fascia/render/gl/backdrop_pass.h>

#include <fascia/render/shaders/sources.h>

namespace fascia::gl {
namespace {

bool isGround(const DrawItem& item) {
  return item.material().kind == Material::Kind::ground && !item.seeThrough();
}

template <class Values>
void append(const Values& values, std::vector<float>& key) {
  key.insert(key.end(), values.data(), values.data() + values.size());
}

void append(const DirectionalLight& light, const Eigen::Vector3f& direction,
            std::vector<float>& key) {
  append(direction, key);
  append(light.color, key);
  key.push_back(light.intensity);
}

std::vector<float> keyOf(const Frame& frame) {
  const Studio& studio = frame.scene->studio;
  const Background& background = frame.scene->background;
  std::vector<float> key{static_cast<float>(frame.width), static_cast<float>(frame.height),
                         background.vignette};
  append(frame.viewFromWorld, key);  // the near and far planes follow the subject, and do not show
  append(frame.tanHalfFov, key);
  append(studio.key, frame.keyDirection, key);
  append(studio.fill, frame.fillDirection, key);
  append(studio.rim, frame.rimDirection, key);
  for (const Rgb& color :
       {studio.sky, studio.horizon, studio.floor, background.top, background.bottom})
    append(color, key);
  for (const DrawItem& item : frame.items) {
    if (!isGround(item)) continue;
    append(item.worldFromObject, key);
    append(item.material().color, key);
    for (const Eigen::Vector3f& p : item.drawable->mesh.positions) append(p, key);
    for (const Eigen::Vector2f& uv : item.drawable->mesh.uvs) append(uv, key);
    for (const auto& t : item.drawable->mesh.triangles)
      for (const std::uint32_t v : t) key.push_back(static_cast<float>(v));
  }
  return key;
}

}  // namespace

BackdropPass::BackdropPass()
    : backgroundProgram_(shaders::kFullScreenVertex,
                         std::string(shaders::kStudio) + shaders::kBackgroundFragment) {}

void BackdropPass::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width, height_ = height;
  emptyIsOf_.clear();
  glBindRenderbuffer(GL_RENDERBUFFER, depth_.id());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  const auto build = [&](const Framebuffer& target, const Renderbuffer& color) {
    glBindRenderbuffer(GL_RENDERBUFFER, color.id());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color.id());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.id());
    requireComplete("a picture");
  };
  build(empty_, emptyColor_);
  build(picture_, color_);
}

void BackdropPass::drawGround(const Frame& frame, const LightPasses& light, LitPrograms& lit,
                              LitPrograms::Part part) {
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);  // no floor seen from below
  glClear(GL_DEPTH_BUFFER_BIT);
  for (const DrawItem& item : frame.items)
    if (isGround(item)) lit.draw(frame, light, item, part);
  glDisable(GL_CULL_FACE);
}

void BackdropPass::drawEmpty(const Frame& frame, const LightPasses& light, LitPrograms& lit) {
  glBindFramebuffer(GL_FRAMEBUFFER, empty_.id());
  glDisable(GL_DEPTH_TEST);
  backgroundProgram_.use();
  setStudio(backgroundProgram_, frame);
  glBindVertexArray(noArrays_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  drawGround(frame, light, lit, LitPrograms::Part::unshadowed);
}

void BackdropPass::draw(const Frame& frame, const LightPasses& light, LitPrograms& lit) {
  resize(frame.width, frame.height);
  glViewport(0, 0, width_, height_);
  std::vector<float> key = keyOf(frame);
  if (key != emptyIsOf_) drawEmpty(frame, light, lit);
  emptyIsOf_ = std::move(key);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, empty_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture_.id());
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, picture_.id());
  for (const ScreenBox& part : frame.shadowedFloor) {
    const ScissorTo shadows(part, width_, height_, 0);
    drawGround(frame, light, lit, LitPrograms::Part::seen);
  }
}

}  // namespace fascia::gl
