#include <fascia/render/shaders/sources.h>

namespace fascia::shaders {

// One source for all passes, and invariant, so that a depth-only pass and the lit pass agree to the
// last bit.
const char* const kMeshVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in float curvature;
layout(location = 4) in vec3 fibre;
uniform mat4 worldFromObject, clipFromWorld;
invariant gl_Position;
out vec3 position_world, normal_world, fibreCoordinate;
out vec2 textureCoordinate;
out float curvature_per_m;

void main() {
  vec4 world = worldFromObject * vec4(position, 1.0);
  position_world = world.xyz;
  normal_world = mat3(worldFromObject) * normal;
  textureCoordinate = uv;
  fibreCoordinate = fibre;
  curvature_per_m = curvature;
  gl_Position = clipFromWorld * world;
}
)";

const char* const kFullScreenVertex = R"(
out vec2 screen;  // (0,0) bottom left, (1,1) top right
void main() {
  screen = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(2.0 * screen - 1.0, 0.0, 1.0);
}
)";

const char* const kDepthFragment = R"(
layout(location = 0) out vec4 result;
void main() { result = vec4(0.0); }
)";

const char* const kGeometryFragment = R"(
in vec3 position_world, normal_world;
uniform mat4 viewFromWorld;
layout(location = 0) out vec4 result;  // view normal; distance along the view axis, 0 = nothing

void main() {
  vec3 n = mat3(viewFromWorld) * normal_world;
  n = normalize(gl_FrontFacing ? n : -n);
  result = vec4(n, -(viewFromWorld * vec4(position_world, 1.0)).z);
}
)";

}  // namespace fascia::shaders
