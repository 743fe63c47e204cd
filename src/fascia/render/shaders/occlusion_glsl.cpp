#include <fascia/render/shaders/sources.h>

namespace fascia::shaders {

// Ambient occlusion: McGuire, Mara & Luebke, "Scalable Ambient Obscurance" (2012), equation of
// section 3, without the depth mip chain. Shadow: Fernando, "Percentage-Closer Soft Shadows"
// (2005). Thickness: Jimenez et al., "Real-Time Realistic Skin Translucency" (2010). Written as: r
// = openness, g = key light, b = exp(-thickness / thicknessScale_m).
const char* const kOcclusionFragment = R"(
in vec2 screen;
uniform sampler2D geometry;
uniform sampler2D shadowDepth;
uniform highp sampler2DShadow shadowCompare;
uniform mat4 worldFromView, shadowFromWorld;
uniform vec3 keyDirection;         // world, towards the light
uniform vec2 tanHalfFov;           // of the view, x and y
uniform float occlusionRadius_m;
uniform float shadowExtent_m;      // width of the shadow map
uniform float shadowDepth_m;       // its depth range
uniform float shadowTexel_m;
uniform float keyRadius;           // tangent of half the light's angle
uniform float thicknessScale_m;
layout(location = 0) out vec4 result;

const int kOcclusionTaps = 14;
const int kBlockerTaps = 8;
const int kShadowTaps = 14;
const float kGoldenAngle = 2.39996323;

// Jimenez, "Next Generation Post Processing in Call of Duty" (2014): noise that a small blur hides.
float interleavedNoise(vec2 pixel) {
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

vec3 viewPosition(vec2 at, float depth) {
  return vec3((2.0 * at - 1.0) * tanHalfFov, -1.0) * depth;
}

vec2 disc(int i, int count, float turn) {
  float a = float(i) * kGoldenAngle + turn;
  return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(a), sin(a));
}

// Loops of no turns stand where an early return would: on a processor a branch costs both sides.
float openness(vec3 p, vec3 n, float turn, bool seen) {
  float radius_uv = 0.5 * occlusionRadius_m / (p.z * -tanHalfFov.y);
  vec2 scale = min(radius_uv, 0.35) * vec2(tanHalfFov.y / tanHalfFov.x, 1.0);
  vec2 size = vec2(textureSize(geometry, 0));
  float r2 = occlusionRadius_m * occlusionRadius_m, sum = 0.0;
  int turns = seen ? kOcclusionTaps : 0;
  for (int i = 0; i < turns; ++i) {
    // On the texel's middle, where its depth was taken: floors seen flatly would shade themselves.
    vec2 at = screen + disc(i, kOcclusionTaps, turn) * scale;
    at = (floor(at * size) + 0.5) / size;
    float depth = texture(geometry, at).a;
    if (depth <= 0.0) continue;
    vec3 v = viewPosition(at, depth) - p;
    float vv = dot(v, v), f = max(r2 - vv, 0.0) / r2;
    sum += f * f * f * max((dot(v, n) - 0.012 * occlusionRadius_m) * occlusionRadius_m /
                           (vv + 0.01 * r2), 0.0);
  }
  return clamp(1.0 - 2.4 * sum / float(kOcclusionTaps), 0.0, 1.0);
}

float keyLight(vec3 p, vec3 n, float turn, bool seen) {
  float slope = 1.0 - abs(dot(n, keyDirection));
  vec3 lifted = p + n * shadowTexel_m * (1.5 + 3.0 * slope);
  vec3 c = (shadowFromWorld * vec4(lifted, 1.0)).xyz;
  bool mapped = all(greaterThanEqual(c.xy, vec2(0.0))) && all(lessThanEqual(c.xy, vec2(1.0)));
  // Blockers can lie as far off as the penumbra of the highest of them reaches.
  float search = keyRadius * 0.3, blockers = 0.0, depths = 0.0;
  int turns = seen && mapped ? kBlockerTaps : 0;
  for (int i = 0; i < turns; ++i) {
    float d = texture(shadowDepth, c.xy + disc(i, kBlockerTaps, turn) * search).r;
    if (d < c.z) { blockers += 1.0; depths += d; }
  }
  float gap_m = max(c.z - depths / max(blockers, 1.0), 0.0) * shadowDepth_m;
  float radius = clamp(keyRadius * gap_m, 1.5 * shadowTexel_m, keyRadius * 0.5 * shadowExtent_m);
  float lit = 0.0;
  turns = blockers > 0.0 ? kShadowTaps : 0;
  for (int i = 0; i < turns; ++i) {
    vec2 at = c.xy + disc(i, kShadowTaps, turn + 0.7) * radius / shadowExtent_m;
    lit += texture(shadowCompare, vec3(at, c.z));
  }
  return blockers > 0.0 ? lit / float(kShadowTaps) : 1.0;
}

// Used on the side that turns away from the light only: see transmitted().
float throughness(vec3 p, vec3 n, float turn, bool seen) {
  vec3 c = (shadowFromWorld * vec4(p - n * 2.0 * shadowTexel_m, 1.0)).xyz;
  float sum = 0.0;
  int turns = seen && dot(n, keyDirection) < 0.35 ? 6 : 0;
  for (int i = 0; i < turns; ++i) {
    vec2 at = c.xy + disc(i, 6, turn) * 0.35 * thicknessScale_m / shadowExtent_m;
    float thickness_m = max(c.z - texture(shadowDepth, at).r, 0.0) * shadowDepth_m;
    sum += exp(-thickness_m / thicknessScale_m);
  }
  return sum / 6.0;
}

void main() {
  vec4 g = texture(geometry, screen);
  bool seen = g.a > 0.0;
  float turn = 6.2831853 * interleavedNoise(floor(gl_FragCoord.xy));
  vec3 p_view = viewPosition(screen, g.a);
  vec3 p = (worldFromView * vec4(p_view, 1.0)).xyz, n = mat3(worldFromView) * g.xyz;
  vec4 found = vec4(openness(p_view, g.xyz, turn, seen), keyLight(p, n, turn, seen),
                    throughness(p, n, turn, seen), 1.0);
  result = seen ? found : vec4(1.0);
}
)";

// Weights fall with distance from the plane of the middle point, so that edges stay sharp.
const char* const kBlurFragment = R"(
in vec2 screen;
uniform sampler2D geometry, source;
uniform vec2 step_uv, tanHalfFov;
layout(location = 0) out vec4 result;

vec3 viewPosition(vec2 at, float depth) {
  return vec3((2.0 * at - 1.0) * tanHalfFov, -1.0) * depth;
}

void main() {
  vec4 g = texture(geometry, screen);
  bool seen = g.a > 0.0;
  vec3 p = viewPosition(screen, g.a);
  float tolerance = 0.012 * g.a;
  vec4 sum = vec4(0.0);
  float weights = 0.0;
  int reach = seen ? 3 : -4;  // nothing to do for the background
  for (int i = -3; i <= reach; ++i) {
    vec2 at = screen + float(i) * step_uv;
    vec4 other = texture(geometry, at);
    float offPlane = abs(dot(viewPosition(at, other.a) - p, g.xyz)) / tolerance;
    float alike = max(dot(other.xyz, g.xyz), 0.0);
    float w = exp(-0.16 * float(i * i) - offPlane * offPlane) * alike * alike * step(1e-6, other.a);
    sum += w * texture(source, at);
    weights += w;
  }
  result = weights > 0.0 ? sum / weights : texture(source, screen);
  if (!seen) result = vec4(1.0);
}
)";

}  // namespace fascia::shaders
