#include <fascia/io/rig_export/rig_geometry.h>

#include <algorithm>

namespace fascia {
namespace {

int accessorCount(const RigSource& source) {
  return static_cast<int>(source.document.root()["accessors"].size());
}

// The index that a member holds; -1: there is none.
int indexOf(const Json& object, std::string_view key) {
  const Json* found = object.find(key);
  return found && found->is(Json::Kind::number) ? static_cast<int>(found->number()) : -1;
}

void eraseWeights(Json& attributes) {
  std::erase_if(attributes.object(), [](const Json::Member& member) {
    return member.key.starts_with("JOINTS_") || member.key.starts_with("WEIGHTS_");
  });
}

// What happens to the vectors of an attribute.
enum class Kind { position, displacement, normal, tangent };

// Replaces an accessor of vectors in a set of attributes by one that is moved.
void moveAttribute(RigSource& source, Json& attributes, const char* name, Kind kind,
                   const PartPlace& from, const Affine& to) {
  const int accessor = indexOf(attributes, name);
  if (accessor < 0 || accessor >= accessorCount(source)) return;
  const int width = kind == Kind::tangent ? 4 : 3;
  std::vector<float> values = source.document.floats(accessor, width);
  for (std::size_t v = 0; v < values.size() / static_cast<std::size_t>(width); ++v) {
    const Affine map = to.inverse() * from.of(v);
    Eigen::Map<Eigen::Vector3f> value(&values[v * static_cast<std::size_t>(width)]);
    Vec3 moved = map.linear() * value.cast<double>();
    if (kind == Kind::position) moved += map.translation();
    if (kind == Kind::normal) {
      moved = map.linear().inverse().transpose() * value.cast<double>();
    }
    if (kind == Kind::normal || kind == Kind::tangent) moved.normalize();
    value = moved.cast<float>();
  }
  putMember(attributes, name,
            source.document.addFloats(values, width == 4 ? "VEC4" : "VEC3",
                                      kind == Kind::position || kind == Kind::displacement));
}

}  // namespace

void setWeights(RigSource& source, std::size_t part, std::span<const PointWeights> weights,
                const std::vector<int>& slot) {
  const RigPart& p = source.clip.model.parts[part];
  const auto of = [&](std::size_t v) -> const PointWeights& {
    return weights[source.clip.model.vertices[p.firstVertex + v].point];
  };
  bool wide = false;
  for (std::size_t v = 0; v < p.vertexCount; ++v) wide = wide || of(v).weight[4] > 0;
  Json& attributes = ensureMember(source.primitive(p), "attributes");
  eraseWeights(attributes);
  for (std::size_t set = 0; set < (wide ? 2u : 1u); ++set) {
    std::vector<std::uint16_t> joints;
    std::vector<float> shares;
    for (std::size_t v = 0; v < p.vertexCount; ++v) {
      for (std::size_t k = 4 * set; k < 4 * set + 4; ++k) {
        const bool used = of(v).weight[k] > 0;
        joints.push_back(used ? static_cast<std::uint16_t>(slot[of(v).joint[k]]) : 0);
        shares.push_back(used ? of(v).weight[k] : 0);
      }
    }
    const std::string number = std::to_string(set);
    putMember(attributes, "JOINTS_" + number, source.document.addJoints(joints));
    putMember(attributes, "WEIGHTS_" + number, source.document.addFloats(shares, "VEC4"));
  }
}

void moveGeometry(RigSource& source, std::size_t part, const Affine& toWorld) {
  PartPlace& place = source.places[part];
  const PartPlace from = place;
  Json& primitive = source.primitive(source.clip.model.parts[part]);
  Json& attributes = ensureMember(primitive, "attributes");
  moveAttribute(source, attributes, "POSITION", Kind::position, from, toWorld);
  moveAttribute(source, attributes, "NORMAL", Kind::normal, from, toWorld);
  moveAttribute(source, attributes, "TANGENT", Kind::tangent, from, toWorld);
  if (Json* targets = findMember(primitive, "targets")) {
    for (Json& target : targets->list()) {
      moveAttribute(source, target, "POSITION", Kind::displacement, from, toWorld);
      moveAttribute(source, target, "NORMAL", Kind::displacement, from, toWorld);
      moveAttribute(source, target, "TANGENT", Kind::displacement, from, toWorld);
    }
  }
  place.toWorld = {toWorld};
}

}  // namespace fascia
