#include <fascia/render/shaders/sources.h>

namespace fascia::shaders {

const char* const kStudio = R"(
uniform vec3 keyDirection, keyColor, fillDirection, fillColor, rimDirection, rimColor;
uniform vec3 skyColor, horizonColor, floorColor;
uniform float exposure;
uniform vec3 backgroundTop, backgroundBottom;  // linear
uniform float vignette;

vec3 srgbFromLinear(vec3 c) {
  return mix(1.055 * pow(max(c, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055, 12.92 * c,
             lessThanEqual(c, vec3(0.0031308)));
}

// Narkowicz, "ACES Filmic Tone Mapping Curve" (2015).
vec3 toneMap(vec3 c) {
  c *= exposure;
  return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
}

// Half a grey level of noise hides the bands of soft gradients.
vec3 dither(vec3 srgb) {
  float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  return srgb + (noise - 0.5) / 255.0;
}

vec3 backgroundColor(vec2 at) {
  vec3 c = mix(backgroundBottom, backgroundTop, smoothstep(0.0, 1.0, at.y));
  vec2 off = at - vec2(0.5, 0.48);
  return c * (1.0 - vignette * smoothstep(0.1, 0.75, length(off)));
}

vec3 roomColor(vec3 d) {
  return mix(horizonColor, d.y > 0.0 ? skyColor : floorColor, smoothstep(0.0, 0.6, abs(d.y)));
}

// A rectangular light panel seen along d; `soft` widens its edges. No early return: derivatives
// need all neighbours.
float panel(vec3 d, vec3 axis, vec2 halfSize, float soft) {
  float along = dot(d, axis);
  vec3 side = normalize(cross(vec3(0.0, 1.0, 0.0), axis));
  vec2 q = abs(vec2(dot(d, side), dot(d, cross(axis, side)))) / max(along, 0.1);
  vec2 edge = vec2(soft) + min(fwidth(q), vec2(0.2));
  vec2 inside = 1.0 - smoothstep(halfSize - edge, halfSize + edge, q);
  return along > 0.1 ? inside.x * inside.y : 0.0;
}

// What a mirror of this roughness reflects. Panels dim as they blur, so that they keep their energy.
vec3 reflectedStudio(vec3 d, float roughness, float keyShadow) {
  float soft = 0.02 + 1.2 * roughness * roughness;
  float dim = 1.0 / (1.0 + 14.0 * roughness * roughness);
  vec3 c = mix(roomColor(d), 0.5 * (horizonColor + roomColor(vec3(0.0, d.y, 0.0))), roughness);
  c += keyColor * (9.0 * dim * keyShadow) * panel(d, keyDirection, vec2(0.26, 0.34), soft);
  c += fillColor * (5.0 * dim) * panel(d, fillDirection, vec2(0.22, 0.5), soft);
  c += rimColor * (4.0 * dim) * panel(d, rimDirection, vec2(0.15, 0.6), soft);
  return c;
}

// Light from everywhere but the key, falling on a matt surface.
vec3 ambientLight(vec3 n) {
  vec3 room = mix(floorColor, skyColor, 0.5 + 0.5 * n.y) * 0.72 + 0.28 * horizonColor;
  float fill = max(0.35 + 0.65 * dot(n, fillDirection), 0.0);
  float rim = max(dot(n, rimDirection), 0.0);
  return 0.46 * room + fillColor * fill * fill * 0.8 + rimColor * rim * 0.45;
}
)";

const char* const kBackgroundFragment = R"(
in vec2 screen;
layout(location = 0) out vec4 result;
void main() { result = vec4(dither(srgbFromLinear(backgroundColor(screen))), 1.0); }
)";

}  // namespace fascia::shaders
