#include <fascia/render/shaders/sources.h>

namespace fascia::shaders {

// Each kind of material but the ground defines the linear radiance towards v at a normal n.
const char* const kMaterial = R"(
#ifdef SKIN
// Light that entered on the far side, after Jimenez et al. (2010): their sum of Gaussians over the
// thickness, in units of the scatter length.
vec3 transmitted(vec3 n, float throughness) {
  float s = -log(max(throughness, 1e-3)) * thicknessScale_m / max(scatter_m, 1e-6);
  float dd = -s * s;
  vec3 profile = vec3(0.118, 0.198, 0.0) * exp(dd / 0.187) + vec3(0.113, 0.007, 0.007) * exp(dd / 0.567) +
                 vec3(0.358, 0.004, 0.0) * exp(dd / 1.99) + vec3(0.078, 0.0, 0.0) * exp(dd / 7.41);
  return profile * clamp(0.3 - dot(n, keyDirection), 0.0, 1.0);
}

vec3 radiance(vec3 n, vec3 v, Occlusion o) {
  float fine = texture(noiseTexture, 9.0 * textureCoordinate).r - 0.5;
  float coarse = texture(noiseTexture, 1.0 * textureCoordinate).r - 0.5;
  vec3 a = albedo() * (1.0 + 0.06 * coarse + 0.03 * fine);
  float rough = clamp(roughness * (1.0 + 0.18 * fine + 0.22 * coarse), 0.05, 1.0);
  float bend = clamp(abs(curvature_per_m) * scatter_m, 0.0, 1.0);
  vec3 direct = texture(scatterLookup, vec2(0.5 + 0.5 * dot(n, keyDirection), bend)).rgb;
  // Blood carries the red; white or dark hides keep the softness without the blush.
  float warmth = smoothstep(0.15, 0.6, (a.r - a.b) / max(a.r, 0.05));
  direct = mix(vec3(dot(direct, vec3(0.35, 0.45, 0.2))), direct, 0.15 + 0.85 * warmth);
  // Red travels farther into a shadow than blue: the penumbra glows.
  vec3 shadow = pow(vec3(max(o.key, 1e-4)), mix(vec3(1.0), vec3(0.72, 0.94, 1.0), translucency * warmth));
  vec3 light = direct * shadow * keyColor + 
               warmth * translucency * transmitted(n, o.throughness) * keyColor;
  light += ambientLight(n) * colouredOpenness(o.openness, a);
  // Two specular lobes: a broad one and a thin oily film.
  vec3 shine = 0.8 * specular(n, v, rough, 0.028, o) + 0.2 * specular(n, v, 0.55 * rough, 0.028, o);
  return a * light + shine;
}
#endif

#ifdef MUSCLE
float fibreHeight(vec2 at, vec2 dx, vec2 dy) { return textureGrad(noiseTexture, at, dx, dy).r; }

vec3 radiance(vec3 n, vec3 v, Occlusion o) {
  vec3 f = fibreCoordinate;
  float round2 = max(dot(f.xy, f.xy), 1e-4);
  // The angle's derivatives in closed form: finite ones jump where the angle wraps.
  vec3 fx = dFdx(f), fy = dFdy(f);
  vec2 scale = vec2(3.0 / 6.2831853, 0.10);
  vec2 at = vec2(atan(f.y, f.x), f.z) * scale;
  vec2 dx = vec2((f.x * fx.y - f.y * fx.x) / round2, fx.z) * scale;
  vec2 dy = vec2((f.x * fy.y - f.y * fy.x) / round2, fy.z) * scale;
  float h = fibreHeight(at, dx, dy);
  float hx = fibreHeight(at + dx, dx, dy) - h, hy = fibreHeight(at + dy, dx, dy) - h;
  float clear = smoothstep(0.02, 0.25, round2);  // fibres meet in a point at the poles
  n = bumpedNormal(position_world, n, 0.35 * scatter_m * clear * hx, 0.35 * scatter_m * clear * hy);
  float tendon = smoothstep(0.72, 1.0, abs(f.z) + 0.25 * (h - 0.5) * clear);
  vec3 a = baseColor * mix(vec3(0.9), mix(vec3(0.62, 0.42, 0.42), vec3(1.05, 0.95, 0.95), h), clear);
  a = mix(a, vec3(0.72, 0.58, 0.50), 0.75 * tendon);
  float nl = clamp((dot(n, keyDirection) + 0.2) / 1.2, 0.0, 1.0);
  vec3 light = vec3(nl * o.key) * keyColor + ambientLight(n) * colouredOpenness(o.openness, a);
  return a * light + specular(n, v, roughness, 0.035, o);
}
#endif

#ifdef BONE
vec3 radiance(vec3 n, vec3 v, Occlusion o) {
  vec3 a = albedo();
  vec3 direct = clamp((vec3(dot(n, keyDirection)) + vec3(0.35, 0.25, 0.15)) /
                      vec3(1.35, 1.25, 1.15), 0.0, 1.0);
  vec3 light = direct * o.key * keyColor + ambientLight(n) * colouredOpenness(o.openness, a);
  return a * light + specular(n, v, roughness, 0.04, o);
}
#endif

#ifdef PLAIN
vec3 radiance(vec3 n, vec3 v, Occlusion o) {
  vec3 a = albedo();
  // Divided so that as much light leaves as came in: Green, "Real-Time Approximations to Subsurface
  // Scattering" (GPU Gems 2004), with the cosine's energy kept.
  float facing = max(dot(n, keyDirection) + wrap, 0.0) / ((1.0 + wrap) * (1.0 + wrap));
  vec3 light = facing * o.key * keyColor + ambientLight(n) * colouredOpenness(o.openness, a);
  vec3 mirror = specular(n, v, roughness, 0.045, o);
  return mix(a * light + mirror, a * specular(n, v, roughness, 1.0, o), metallic);
}
#endif
)";

}  // namespace fascia::shaders
