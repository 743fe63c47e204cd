#include <fascia/io/gltf_writer.h>

#include <cmath>

#include <fascia/io/file.h>
#include <fascia/io/gltf_skin.h>
#include <fascia/io/keep_frames.h>
#include <fascia/io/welded_normals.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

using GltfJson = GlbBuilder::Json;

// A joint's place in its parent over time.
struct JointTrack {
  std::vector<Eigen::Vector3f> translations;
  std::vector<Eigen::Vector4f> rotations;  // quaternions x, y, z, w; neighbours on one side
};

Eigen::Vector4f quaternion(const Mat3& rotation) {
  return Quat(rotation).normalized().coeffs().cast<float>();
}

std::vector<JointTrack> jointTracks(const Skeleton& skeleton, const Recording& recording) {
  std::vector<JointTrack> tracks(skeleton.jointCount());
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
      Eigen::Vector4f rotation = quaternion(local.rotation);
      std::vector<Eigen::Vector4f>& rotations = tracks[j].rotations;
      if (!rotations.empty() && rotations.back().dot(rotation) < 0) rotation = -rotation;
      rotations.push_back(rotation);
      tracks[j].translations.push_back(local.translation_m.cast<float>());
    }
  }
  return tracks;
}

GltfJson jointNode(const std::string& name, const JointTrack& track) {
  const Eigen::Vector3f& t = track.translations.front();
  const Eigen::Vector4f& r = track.rotations.front();
  return {{"name", name},
          {"translation", {t.x(), t.y(), t.z()}},
          {"rotation", {r.x(), r.y(), r.z(), r.w()}}};
}

// Drops values that lie between their neighbours within `tolerance` (metres, or about radians / 2).
template <class Value, class AddValues>
void addTrack(const std::vector<float>& times, const std::vector<Value>& values, float tolerance,
              std::size_t node, const char* path, GlbBuilder& glb, GltfAnimation& animation,
              const AddValues& addValues) {
  const std::vector<std::size_t> kept =
      keepFrames(values.size(), [&](std::size_t a, std::size_t b) {
        for (std::size_t f = a + 1; f < b; ++f) {
          const float s = (times[f] - times[a]) / (times[b] - times[a]);
          Value blend = values[a] + s * (values[b] - values[a]);
          if constexpr (Value::RowsAtCompileTime == 4) blend.normalize();
          if (!((blend - values[f]).norm() <= tolerance)) return false;
        }
        return true;
      });
  bool moves = false;
  std::vector<float> keptTimes;
  std::vector<Value> keptValues;
  for (const std::size_t k : kept) {
    keptTimes.push_back(times[k]);
    keptValues.push_back(values[k]);
    moves = moves || values[k] != values[0];
  }
  if (!moves) return;
  const std::size_t input = glb.addScalars(keptTimes, true);
  animation.add(input, addValues(keptValues), node, path);
}

class GlbWriter {
 public:
  GlbWriter(const Character& character, const Recording& recording, const GlbOptions& options)
      : character_(character), recording_(recording), options_(options) {}

  GlbReport write(const std::string& path) {
    check();
    addJoints();
    if (options_.ornaments) addSolids(character_.ornaments());
    if (options_.solids) addSolids(character_.flesh());
    addSkin();
    finishScene();
    const std::string bytes = glb_.finish();
    writeFileWhole(path, bytes);
    return {kept_.size(), bytes.size()};
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
    const std::vector<JointTrack> tracks = jointTracks(skeleton, recording_);
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      const JointId id(static_cast<std::int64_t>(j));
      addNode(jointNode(skeleton.joint(id).name, tracks[j]), skeleton.parent(id));
    }
    constexpr float kMetres = 1e-5f, kHalfRadians = 1e-4f;
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      addTrack(times, tracks[j].translations, kMetres, j, "translation", glb_, animation_,
               [&](const auto& values) {
                 return glb_.addVectors(values, false, GlbBuilder::Target::none);
               });
      addTrack(times, tracks[j].rotations, kHalfRadians, j, "rotation", glb_, animation_,
               [&](const auto& values) { return glb_.addQuaternions(values); });
    }
  }

  std::size_t addNode(GltfJson node, JointId parent) {
    const std::size_t index = glb_.add("nodes", std::move(node));
    if (parent.valid()) {
      glb_.root["nodes"][parent.index()]["children"].push_back(index);
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
      const auto vertices = GlbBuilder::Target::vertices;
      GltfJson primitive;
      primitive["attributes"] = {{"POSITION", glb_.addVectors(mesh.positions, true, vertices)},
                                 {"NORMAL", glb_.addVectors(mesh.normals, false, vertices)}};
      primitive["indices"] = glb_.addIndices(
          {mesh.triangles.data()->data(), 3 * mesh.triangles.size()}, mesh.positions.size());
      primitive["material"] = solidMaterial(def.color);
      const std::size_t index =
          glb_.add("meshes", {{"name", def.name}, {"primitives", GltfJson::array({primitive})}});
      const Vec3& t = def.position_m;
      const Eigen::Vector4f r = quaternion(rotationZyx(def.orientation_rad));
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

  void finishScene() {
    GltfJson scene = {{"nodes", roots_}};
    if (!character_.def().name.empty()) scene["name"] = character_.def().name;
    glb_.add("scenes", std::move(scene));
    glb_.root["scene"] = 0;
    if (animation_.channels.empty()) return;
    glb_.add("animations", {{"name", recording_.motion.empty() ? "rest" : recording_.motion},
                            {"samplers", animation_.samplers},
                            {"channels", animation_.channels}});
  }

  const Character& character_;
  const Recording& recording_;
  const GlbOptions& options_;
  GlbBuilder glb_;
  GltfAnimation animation_;
  std::vector<std::size_t> roots_, kept_;
  std::vector<std::pair<GltfJson, std::size_t>> materials_;
};

}  // namespace

GlbReport writeGlb(const Character& character, const Recording& recording, const std::string& path,
                   const GlbOptions& options) {
  return GlbWriter(character, recording, options).write(path);
}

}  // namespace fascia
