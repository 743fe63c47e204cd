#pragma once

#include <array>
#include <memory>

#include <fascia/render/gl/frame.h>
#include <fascia/render/gl/occlusion_pass.h>
#include <fascia/render/look.h>

namespace fascia::gl {

// How light finds out what is in its way: by the occlusion pass, or, in the fast look, by the
// shadow map alone.
struct LightPasses {
  const ShadowPass& shadow;
  const OcclusionPass* occlusion;  // null in the fast look
};

// Programs that light a surface, one per kind of material.
class LitPrograms {
 public:
  enum class Part { seen, unshadowed, hidden };  // hidden: what shows through others (x-ray)

  explicit LitPrograms(Look look);
  // Draws an item with the depth test, blending and culling that are set.
  void draw(const Frame& frame, const LightPasses& light, const DrawItem& item,
            Part part = Part::seen);

 private:
  Program& program(Material::Kind kind);
  void bindTextures(Program& program, const DrawItem& item);

  Look look_;
  std::array<std::unique_ptr<Program>, 5> programs_;  // by kind, made when first needed
  Texture scatterLookup_, noise_;
};

// Sets the uniforms of shaders::kStudio.
void setStudio(Program& program, const Frame& frame);

}  // namespace fascia::gl
