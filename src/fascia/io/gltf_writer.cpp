#include <fascia/io/gltf_writer.h>

#include <cmath>

#include <fascia/geometry/welded_normals.h>
#include <fascia/io/file.h>
#include <fascia/io/gltf_skin.h>
#include <fascia/io/gltf_tracks.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

using GltfJson = GlbBuilder::Json;

std::vector<PlaceTrack> jointTracks(const Skeleton& skeleton, const Recording& recording) {
  std::vector<PlaceTrack> tracks(skeleton.jointCount());
  Posture posture = skeleton.restPosture();
  PosedSkeleton posed;
  for (const Recording::Frame& frame : recording.frames) {
    if (frame.posture.size() == posture.values.size()) posture.values = frame.posture;
    skeleton.pose(posture, posed);
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      const JointId parent = skeleton.parent(JointId(static_cast<std::int64_t>(j)));
      const Transform local =
          parent.valid() ? posed.joint_world[parent.index()].inverse() * posed.joint_world[j]
                         : posed.joint_world[j];
      tracks[j].add(local);
    }
  }
  return tracks;
}

class CharacterNodes {
 public:
  CharacterNodes(const Character& character, const Recording& recording, const GlbOptions& options,
                 GlbBuilder& glb, GltfAnimation& animation)
      : character_(character),
        recording_(recording),
        options_(options),
        glb_(glb),
        animation_(animation) {}

  GlbCharacter add() {
    check();
    addJoints();
    if (options_.ornaments) addSolids(character_.ornaments());
    if (options_.solids) addSolids(character_.flesh());
    addSkin();
    return {std::move(roots_), kept_.size()};
  }

 private:
  bool hasSkin() const {
    return character_.def().skin && !recording_.frames.front().skin_m.empty();
  }

  void check() const {
    if (recording_.frames.empty()) throw Error("a recording without frames cannot be exported");
    const bool skin = hasSkin();
    const std::size_t vertices = skin ? recording_.skin.positions.size() : 0;
    for (std::size_t f = 0; f < recording_.frames.size(); ++f) {
      const Recording::Frame& frame = recording_.frames[f];
      if (frame.skin_m.size() != vertices) throw Error("a frame of the recording lacks its skin");
      if (f > 0 && !(frame.time_s > recording_.frames[f - 1].time_s)) {
        throw Error("the frames of the recording are not in order");
      }
      for (const Eigen::Vector3f& p : frame.skin_m) {
        if (!p.allFinite()) throw Error("the recording holds a position that is no number");
      }
    }
    if (skin && recording_.skin.triangles.empty()) throw Error("the skin has no triangles");
  }

  void addJoints() {
    const Skeleton& skeleton = character_.skeleton();
    std::vector<float> times;
    for (const Recording::Frame& frame : recording_.frames) {
      times.push_back(static_cast<float>(frame.time_s - recording_.frames.front().time_s));
    }
    const std::vector<PlaceTrack> tracks = jointTracks(skeleton, recording_);
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      const JointId id(static_cast<std::int64_t>(j));
      jointNodes_.push_back(
          addNode(placeNode(skeleton.joint(id).name, tracks[j]), skeleton.parent(id)));
    }
    for (std::size_t j = 0; j < tracks.size(); ++j)
      addTracks(times, tracks[j], jointNodes_[j], glb_, animation_);
  }

  std::size_t addNode(GltfJson node, JointId parent) {
    const std::size_t index = glb_.add("nodes", std::move(node));
    if (parent.valid()) {
      glb_.root["nodes"][jointNodes_[parent.index()]]["children"].push_back(index);
    } else {
      roots_.push_back(index);
    }
    return index;
  }

  // Rigid meshes that follow their joints, as they are at rest.
  void addSolids(const Flesh& flesh) {
    for (std::size_t s = 0; s < flesh.solidCount(); ++s) {
      const SolidId id(static_cast<std::int64_t>(s));
      const FleshSolidDef& def = flesh.def(id);
      TriangleMesh mesh = flesh.restSolid(id).tessellate(options_.solidDetail);
      WeldedNormals(mesh).compute(mesh.positions, mesh.normals);
      const GltfJson primitive = addPrimitive(mesh, solidMaterial(def.color), glb_);
      const std::size_t index =
          glb_.add("meshes", {{"name", def.name}, {"primitives", GltfJson::array({primitive})}});
      const Vec3& t = def.position_m;
      const Eigen::Vector4f r = gltfQuaternion(rotationZyx(def.orientation_rad));
      addNode({{"name", def.name},
               {"mesh", index},
               {"translation", {t.x(), t.y(), t.z()}},
               {"rotation", {r.x(), r.y(), r.z(), r.w()}}},
              flesh.joint(id));
    }
  }

  // One material per colour.
  std::size_t solidMaterial(const Color& color) {
    const GltfJson linear = linearColor(color.r, color.g, color.b);
    for (const auto& [known, index] : materials_) {
      if (known == linear) return index;
    }
    const GltfJson surface = {
        {"baseColorFactor", linear}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.4}};
    const std::size_t index = glb_.add("materials", {{"pbrMetallicRoughness", surface}});
    materials_.emplace_back(linear, index);
    return index;
  }

  void addSkin() {
    if (!hasSkin()) return;
    const Texture texture = options_.texture ? *options_.texture : loadTexture(character_.def());
    const std::size_t mesh =
        addSkinMesh(*character_.def().skin, recording_, texture, options_.tolerance_m, glb_, kept_);
    const std::size_t node = addNode({{"name", "skin"}, {"mesh", mesh}}, JointId());
    addSkinAnimation(recording_, kept_, node, glb_, animation_);
  }

  const Character& character_;
  const Recording& recording_;
  const GlbOptions& options_;
  GlbBuilder& glb_;
  GltfAnimation& animation_;
  std::vector<std::size_t> jointNodes_, roots_, kept_;
  std::vector<std::pair<GltfJson, std::size_t>> materials_;
};

}  // namespace

GlbCharacter addCharacter(const Character& character, const Recording& recording,
                          const GlbOptions& options, GlbBuilder& glb, GltfAnimation& animation) {
  return CharacterNodes(character, recording, options, glb, animation).add();
}

std::string finishGlb(const std::string& name, const std::string& motion,
                      const std::vector<std::size_t>& roots, GltfAnimation animation,
                      GlbBuilder& glb) {
  GltfJson scene = {{"nodes", roots}};
  if (!name.empty()) scene["name"] = name;
  glb.add("scenes", std::move(scene));
  glb.root["scene"] = 0;
  if (!animation.channels.empty())
    glb.add("animations", {{"name", motion.empty() ? "rest" : motion},
                           {"samplers", std::move(animation.samplers)},
                           {"channels", std::move(animation.channels)}});
  return glb.finish();
}

GlbReport writeGlb(const Character& character, const Recording& recording, const std::string& path,
                   const GlbOptions& options) {
  GlbBuilder glb;
  GltfAnimation animation;
  const GlbCharacter added = addCharacter(character, recording, options, glb, animation);
  const std::string bytes =
      finishGlb(character.def().name, recording.motion, added.roots, std::move(animation), glb);
  writeFileWhole(path, bytes);
  return {added.framesKept, bytes.size()};
}

}  // namespace fascia
