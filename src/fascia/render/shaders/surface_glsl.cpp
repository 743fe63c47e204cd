#include <fascia/render/shaders/sources.h>

namespace fascia::shaders {

const char* const kSurface = R"(
uniform sampler2D geometry, occlusion;
uniform vec2 occlusionSize;    // pixels
uniform mat4 viewFromWorld;
uniform float unoccluded;      // 1: a see-through layer, which the occlusion pass did not see

// The occlusion of this fragment's own surface: the four nearest texels, weighted by how well their
// depth fits. Plain interpolation would leave halos along outlines.
Occlusion occlusionHere(vec3 position_world, vec3 n) {
  if (unoccluded > 0.5) return Occlusion(1.0, 1.0, 0.0);
  float depth = -(viewFromWorld * vec4(position_world, 1.0)).z;
  vec2 at = gl_FragCoord.xy / targetSize * occlusionSize - 0.5;
  ivec2 base = ivec2(floor(at)), last = ivec2(occlusionSize) - 1;
  vec2 f = at - floor(at);
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 offset = ivec2(i & 1, i >> 1);
    ivec2 texel = clamp(base + offset, ivec2(0), last);
    float off = (texelFetch(geometry, texel, 0).a - depth) / (0.01 * depth);
    vec2 b = mix(1.0 - f, f, vec2(offset)) + 0.01;
    float w = b.x * b.y / (1.0 + off * off * off * off) + 1e-6;
    sum += w * texelFetch(occlusion, texel, 0).rgb;
    weights += w;
  }
  sum /= weights;
  return Occlusion(sum.r, sum.g, sum.b);
}

// Light that bounces inside a crease takes on its colour: Jimenez et al., "Practical Realtime
// Strategies for Accurate Indirect Occlusion" (2016).
vec3 colouredOpenness(float openness, vec3 albedo) {
  vec3 a = 2.0404 * albedo - 0.3324, b = -4.7951 * albedo + 0.6417, c = 2.7552 * albedo + 0.6903;
  return max(vec3(openness), ((openness * a + b) * openness + c) * openness);
}

// Trowbridge–Reitz (GGX) distribution with Smith's visibility (Schlick's form).
float ggx(vec3 n, vec3 v, vec3 l, float roughness) {
  vec3 h = normalize(v + l);
  float nh = max(dot(n, h), 0.0), nl = max(dot(n, l), 0.0), nv = max(dot(n, v), 1e-3);
  float a = roughness * roughness, a2 = a * a, d = nh * nh * (a2 - 1.0) + 1.0;
  float k = 0.5 * a;
  return nl * a2 / (12.566 * d * d * mix(nl, 1.0, k) * mix(nv, 1.0, k));
}

float fresnel(float cosine, float f0) { return f0 + (1.0 - f0) * pow(1.0 - cosine, 5.0); }

// Karis, "Physically Based Shading on Mobile" (2014): the environment's share of a rough mirror.
float environmentShare(float nv, float roughness, float f0) {
  vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
  return max(f0 * (-1.04 * a + r.z) + 1.04 * a + r.w, 0.0);
}

// Everything shiny: key light by its distribution when rough, by its panel's mirror image when
// smooth (eyes), and the room.
vec3 specular(vec3 n, vec3 v, float roughness, float f0, Occlusion o) {
  float nv = max(dot(n, v), 1e-3);
  float openness = clamp(pow(nv + o.openness, 2.0) - 1.0 + o.openness, 0.0, 1.0);
  float mirror = 1.0 - smoothstep(0.12, 0.35, roughness);
  vec3 room = reflectedStudio(reflect(-v, n), roughness, mirror * o.key);
  vec3 h = normalize(v + keyDirection);
  float key = ggx(n, v, keyDirection, roughness) * fresnel(max(dot(v, h), 0.0), f0) * 3.1416;
  return room * environmentShare(nv, roughness, f0) * openness +
         keyColor * (key * o.key * (1.0 - mirror));
}

// Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU" (2010), equation 4 and 5.
vec3 bumpedNormal(vec3 position, vec3 n, float heightX_m, float heightY_m) {
  vec3 px = dFdx(position), py = dFdy(position);
  vec3 rx = cross(py, n), ry = cross(n, px);
  float det = dot(px, rx);
  return normalize(abs(det) * n - sign(det) * (heightX_m * rx + heightY_m * ry));
}
)";

}  // namespace fascia::shaders
