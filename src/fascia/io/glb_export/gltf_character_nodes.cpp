#include <fascia/io/glb_export/gltf_character_nodes.h>

#include <algorithm>
#include <cmath>

#include <fascia/geometry/welded_normals.h>
#include <fascia/io/glb_export/gltf_skin.h>
#include <fascia/io/glb_export/gltf_tracks.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

// Of the largest solid's radius: as near chords stay to a solid's roundness. A claw needs fewer
// segments than a belly.
constexpr double kRoundness = 1e-3;
constexpr int kLeastDetail = 12;

double radiusOf_m(const Solid& solid) {
  return solid.halfExtents_m().maxCoeff();
}

double largestRadius_m(const Flesh& flesh) {
  double largest = 0;
  for (std::size_t s = 0; s < flesh.solidCount(); ++s)
    largest = std::max(largest, radiusOf_m(flesh.restSolid(SolidId(static_cast<std::int64_t>(s)))));
  return largest;
}

int detailFor(const Solid& solid, double roundness_m, int most) {
  const double segments =
      kPi / std::acos(std::max(0.0, 1 - roundness_m / std::max(radiusOf_m(solid), 1e-9)));
  // Even, so that the poles and the sides of a shape are among its vertices.
  const int even = 2 * static_cast<int>(std::ceil(std::min(segments, 1e4) / 2));
  return std::min(most, std::max(kLeastDetail, even));
}

}  // namespace

Transform localFrame(const Skeleton& skeleton, const PosedSkeleton& posed, std::size_t joint) {
  const JointId parent = skeleton.parent(JointId(static_cast<std::int64_t>(joint)));
  const Transform& world = posed.joint_world[joint];
  return parent.valid() ? posed.joint_world[parent.index()].inverse() * world : world;
}

GltfCharacterNodes::GltfCharacterNodes(const Character& character, GltfBuilder& glb)
    : character_(character),
      glb_(glb),
      roundness_m_(kRoundness * std::max(largestRadius_m(character.flesh()),
                                         largestRadius_m(character.ornaments()))) {}

void GltfCharacterNodes::addJoints(std::vector<Json> nodes) {
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    const JointId id(static_cast<std::int64_t>(j));
    joints_.push_back(add(std::move(nodes[j]), character_.skeleton().parent(id)));
  }
}

int GltfCharacterNodes::add(Json node, JointId parent) {
  const int index = glb_.add("nodes", std::move(node));
  if (parent.valid()) {
    Json& above = glb_.document.item("nodes", joints_[parent.index()]);
    ensureList(above, "children").list().push_back(index);
  } else {
    roots_.push_back(index);
  }
  return index;
}

void GltfCharacterNodes::addSolids(const Flesh& flesh, int detail) {
  for (std::size_t s = 0; s < flesh.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    const FleshSolidDef& def = flesh.def(id);
    Json primitive = geometryOf(flesh.restSolid(id), detail);
    putMember(primitive, "material", materialOf(def.color));
    const int mesh = glb_.add(
        "meshes",
        Json::Object{{"name", def.name}, {"primitives", Json::List{std::move(primitive)}}});
    const Vec3& t = def.position_m;
    const Eigen::Vector4f r = gltfQuaternion(rotationZyx(def.orientation_rad));
    add(Json::Object{{"name", def.name},
                     {"mesh", mesh},
                     {"translation", numberList(t)},
                     {"rotation", numberList(r)}},
        flesh.joint(id));
  }
}

Json GltfCharacterNodes::geometryOf(const Solid& solid, int detail) {
  TriangleMesh mesh = solid.tessellate(detailFor(solid, roundness_m_, detail));
  for (const auto& [known, primitive] : geometries_) {
    if (known.positions == mesh.positions && known.triangles == mesh.triangles) return primitive;
  }
  WeldedNormals(mesh).compute(mesh.positions, mesh.normals);
  mesh.uvs.clear();  // their materials are one colour each
  geometries_.emplace_back(mesh, addPrimitive(mesh, 0, glb_));
  return geometries_.back().second;
}

// One material per colour.
int GltfCharacterNodes::materialOf(const Color& color) {
  const std::array<float, 3> wanted{color.r, color.g, color.b};
  for (const auto& [known, index] : materials_) {
    if (known == wanted) return index;
  }
  materials_.emplace_back(wanted, addMaterial(color, 0.4, glb_));
  return materials_.back().second;
}

}  // namespace fascia
