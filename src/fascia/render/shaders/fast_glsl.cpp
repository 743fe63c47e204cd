#include <fascia/render/shaders/sources.h>

namespace fascia::shaders {

const char* const kFastSurface = R"(
uniform highp sampler2DShadow shadowCompare;
uniform mat4 shadowFromWorld;
uniform float shadowTexel_m;
uniform float unoccluded;

#ifdef GROUND
const int kTaps = 6;
#else
const int kTaps = 1;
#endif

// One comparison on the subject; on the floor a few, or the shadow's stairs would be seen.
Occlusion occlusionHere(vec3 position_world, vec3 n) {
  vec3 c = (shadowFromWorld * vec4(position_world + n * (3.0 * shadowTexel_m), 1.0)).xyz;
  float lit = 0.0;
  vec2 texel = 1.0 / vec2(textureSize(shadowCompare, 0));
  for (int i = 0; i < kTaps; ++i) {
    float a = float(i) * 2.39996323;
    vec2 off = kTaps > 1 ? sqrt((float(i) + 0.5) / float(kTaps)) * 2.5 * vec2(cos(a), sin(a)) : vec2(0.0);
    lit += texture(shadowCompare, vec3(c.xy + off * texel, c.z));
  }
  bool mapped = all(greaterThanEqual(c.xy, vec2(0.0))) && all(lessThanEqual(c.xy, vec2(1.0)));
  return Occlusion(1.0, mapped && unoccluded < 0.5 ? lit / float(kTaps) : 1.0, 0.0);
}
)";

// One model for all kinds: matt light that creeps around what is soft, and the key's highlight.
const char* const kFastMaterial = R"(
vec3 radiance(vec3 n, vec3 v, Occlusion o) {
  vec3 a = albedo();
#if defined(SKIN)
  vec3 around = vec3(0.35, 0.22, 0.16);
#elif defined(MUSCLE)
  vec3 around = vec3(0.2);
  a *= 0.8;
#elif defined(BONE)
  vec3 around = vec3(0.35, 0.25, 0.15);
#else
  vec3 around = vec3(wrap);
#endif
  vec3 facing = max((dot(n, keyDirection) + around) / (1.0 + around), 0.0);
  // Where a surface turns away it shades itself: the map's hard edge there would only show.
  float key = mix(1.0, o.key, smoothstep(0.0, 0.35, dot(n, keyDirection)));
  vec3 light = facing * key * keyColor + 0.92 * ambientLight(n);
  vec3 h = normalize(v + keyDirection);
  float rough = max(roughness, 0.12), r2 = rough * rough, r4 = r2 * r2;
  float nh = max(dot(n, h), 0.0), d = nh * nh * (r4 - 1.0) + 1.0;
  float shine = 0.012 * r4 / (d * d * r2) * o.key;
  return a * light + keyColor * mix(vec3(shine), 12.0 * a * shine, metallic);
}
)";

}  // namespace fascia::shaders
