#include <fascia/render/gl/lit_programs.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <fascia/render/lookups.h>
#include <fascia/render/mip_levels.h>
#include <fascia/render/shaders/sources.h>

namespace fascia::gl {
namespace {

constexpr int kLookupWidth = 128, kLookupHeight = 32, kNoiseSide = 512;

enum Unit { kColorUnit, kFirstLightUnit, kSecondLightUnit, kLookupUnit, kNoiseUnit };

Eigen::Vector3f linearFromSrgb(const Rgb& c) {
  return c.unaryExpr([](float s) {
    s = std::clamp(s, 0.f, 1.f);
    return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
  });
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

void setCamera(Program& program, const Frame& frame, const DrawItem& item) {
  program.set("targetSize",
              Eigen::Vector2f(static_cast<float>(frame.width), static_cast<float>(frame.height)));
  program.set("eye_world", Eigen::Vector3f(frame.scene->camera.eye_m.cast<float>()));
  program.set("viewFromWorld", frame.viewFromWorld);
  program.set("clipFromWorld", frame.clipFromWorld);
  program.set("worldFromObject", item.worldFromObject);
  program.set("thicknessScale_m", frame.thicknessScale_m);
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

void setStudio(Program& program, const Frame& frame) {
  const Studio& studio = frame.scene->studio;
  const Background& background = frame.scene->background;
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
  program.set("backgroundTop", linearFromSrgb(background.top));
  program.set("backgroundBottom", linearFromSrgb(background.bottom));
  program.set("vignette", background.vignette);
}

LitPrograms::LitPrograms(Look look) : look_(look) {
  if (look == Look::fast) return;
  const auto lookup = scatterLookup(kLookupWidth, kLookupHeight);
  allocateTexture(scatterLookup_, kLookupWidth, kLookupHeight, {GL_RGB16F, GL_RGB, GL_FLOAT},
                  GL_LINEAR, lookup.data());
  uploadNoise(noise_);
}

Program& LitPrograms::program(Material::Kind kind) {
  constexpr std::array<const char*, 5> defines{"#define SKIN\n", "#define MUSCLE\n",
                                               "#define BONE\n", "#define PLAIN\n",
                                               "#define GROUND\n"};
  const auto index = static_cast<std::size_t>(kind);
  auto& program = programs_[index];
  if (!program) {
    const std::string look = look_ == Look::fast ? "#define FAST\n" : "";
    const char* surface = look_ == Look::fast ? shaders::kFastSurface : shaders::kSurface;
    const char* material = look_ == Look::fast ? shaders::kFastMaterial : shaders::kMaterial;
    program = std::make_unique<Program>(shaders::kMeshVertex,
                                        std::string(shaders::kStudio) + shaders::kLitInputs +
                                            surface + material + shaders::kLitMain,
                                        look + defines[index]);
  }
  return *program;
}

void LitPrograms::bindTextures(Program& program, const DrawItem& item) {
  bindTexture(kColorUnit, item.texture);
  if (item.texture != 0)
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T,
                    item.material().tiled ? GL_REPEAT : GL_CLAMP_TO_EDGE);
  program.set("colorTexture", kColorUnit);
  if (look_ == Look::fast) return;
  bindTexture(kLookupUnit, scatterLookup_.id());
  bindTexture(kNoiseUnit, noise_.id());
  program.set("scatterLookup", kLookupUnit);
  program.set("noiseTexture", kNoiseUnit);
}

void LitPrograms::draw(const Frame& frame, const LightPasses& light, const DrawItem& item,
                       Part part) {
  Program& lit = program(item.material().kind);
  lit.use();
  setStudio(lit, frame);
  setMaterial(lit, item);
  setCamera(lit, frame, item);
  bindTextures(lit, item);
  if (light.occlusion)
    light.occlusion->bind(lit, kFirstLightUnit, kSecondLightUnit);
  else
    light.shadow.bind(lit, kFirstLightUnit, kSecondLightUnit);
  const bool occluded = item.casts() || item.material().kind == Material::Kind::ground;
  lit.set("unoccluded", occluded && part == Part::seen ? 0.f : 1.f);
  lit.set("ghost", part == Part::hidden ? std::clamp(item.material().xray, 0.f, 1.f) : 0.f);
  item.mesh->draw();
}

}  // namespace fascia::gl
