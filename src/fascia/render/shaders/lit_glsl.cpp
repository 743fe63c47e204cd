#include <fascia/render/shaders/sources.h>

namespace fascia::shaders {

const char* const kLitInputs = R"(
in vec3 position_world, normal_world, fibreCoordinate;
in vec2 textureCoordinate;
in float curvature_per_m;
uniform vec3 eye_world, baseColor;  // baseColor is linear
uniform float roughness, scatter_m, translucency, opacity, ghost, thicknessScale_m;
uniform float metallic, wrap;
uniform vec2 targetSize;  // pixels
uniform int textured;
uniform sampler2D colorTexture, scatterLookup, noiseTexture;
layout(location = 0) out vec4 result;

vec3 albedo() {
  return textured == 1 ? baseColor * texture(colorTexture, textureCoordinate).rgb : baseColor;
}

struct Occlusion {
  float openness, key, throughness;
};
)";

const char* const kLitMain = R"(
#ifdef GROUND
// The floor is the backdrop with a pool of its own colour in the middle and the shadows on it: it
// has no horizon, because it ends as the backdrop.
void main() {
  float r = length(textureCoordinate);
  Occlusion o = occlusionHere(position_world, vec3(0.0, 1.0, 0.0));
  vec3 key = keyColor * max(keyDirection.y, 0.05), room = ambientLight(vec3(0.0, 1.0, 0.0));
  vec3 shade = (key * o.key + room * o.openness) / (key + room);
  shade = mix(shade, vec3(1.0), smoothstep(0.45, 0.9, r));
  vec3 backdrop = backgroundColor(gl_FragCoord.xy / targetSize);
  float pool = exp(-14.0 * r * r) * (1.0 - smoothstep(0.5, 0.95, r));
  result = vec4(dither(srgbFromLinear(mix(backdrop, baseColor, 0.8 * pool) * shade)), 1.0);
}
#else
void main() {
  vec3 n = normalize(gl_FrontFacing ? normal_world : -normal_world);
  vec3 v = normalize(eye_world - position_world);
  vec3 c = radiance(n, v, occlusionHere(position_world, n));
  float rim = pow(1.0 - clamp(dot(n, v), 0.0, 1.0), 2.5);
  float alpha = opacity < 1.0 ? mix(opacity, 1.0, 0.9 * rim) : 1.0;
  if (opacity < 1.0) c *= 1.0 - 0.45 * rim;  // a veil's outline reads on any backdrop
  if (ghost > 0.0) alpha = ghost * (1.0 - 0.5 * rim);
  result = vec4(dither(srgbFromLinear(toneMap(c))), alpha);
}
#endif
)";

const char* const kLayerFragment = R"(
uniform sampler2D layer;
layout(location = 0) out vec4 result;
void main() { result = texelFetch(layer, ivec2(gl_FragCoord.xy), 0); }
)";

}  // namespace fascia::shaders
