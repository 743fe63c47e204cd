#include <fascia/io/glb_export/gltf_writer.h>

#include <cmath>

#include <fascia/io/file/file.h>
#include <fascia/io/glb_export/character_gltf.h>
#include <fascia/io/glb_export/gltf_character_nodes.h>
#include <fascia/io/glb_export/gltf_skin.h>
#include <fascia/io/glb_export/gltf_tracks.h>
#include <fascia/io/gltf/gltf_animation.h>

namespace fascia {
namespace {

std::vector<PlaceTrack> jointTracks(const Skeleton& skeleton, const Recording& recording) {
  std::vector<PlaceTrack> tracks(skeleton.jointCount());
  Posture posture = skeleton.restPosture();
  PosedSkeleton posed;
  for (const Recording::Frame& frame : recording.frames) {
    if (frame.posture.size() == posture.values.size()) posture.values = frame.posture;
    skeleton.pose(posture, posed);
    for (std::size_t j = 0; j < tracks.size(); ++j) tracks[j].add(localFrame(skeleton, posed, j));
  }
  return tracks;
}

class CharacterWriter {
 public:
  CharacterWriter(const Character& character, const Recording& recording, const GlbOptions& options,
                  GltfBuilder& glb, Json& animation)
      : character_(character),
        recording_(recording),
        options_(options),
        glb_(glb),
        animation_(animation),
        nodes_(character, glb) {}

  GltfCharacter add() {
    check();
    addJoints();
    if (options_.ornaments) nodes_.addSolids(character_.ornaments(), options_.solidDetail);
    if (options_.solids) nodes_.addSolids(character_.flesh(), options_.solidDetail);
    addSkin();
    return {nodes_.roots(), kept_.size()};
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
    std::vector<Json> nodes;
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      const JointId id(static_cast<std::int64_t>(j));
      nodes.push_back(placeNode(skeleton.joint(id).name, tracks[j]));
    }
    nodes_.addJoints(std::move(nodes));
    for (std::size_t j = 0; j < tracks.size(); ++j)
      addTracks(times, tracks[j], nodes_.joints()[j], glb_, animation_);
  }

  void addSkin() {
    if (!hasSkin()) return;
    const Texture texture = options_.texture ? *options_.texture : loadTexture(character_.def());
    const int mesh =
        addSkinMesh(*character_.def().skin, recording_, texture, options_.tolerance_m, glb_, kept_);
    const int node = nodes_.add(Json::Object{{"name", "skin"}, {"mesh", mesh}}, JointId());
    addSkinAnimation(recording_, kept_, node, glb_, animation_);
  }

  const Character& character_;
  const Recording& recording_;
  const GlbOptions& options_;
  GltfBuilder& glb_;
  Json& animation_;
  GltfCharacterNodes nodes_;
  std::vector<std::size_t> kept_;
};

}  // namespace

GltfCharacter addCharacter(const Character& character, const Recording& recording,
                           const GlbOptions& options, GltfBuilder& glb, Json& animation) {
  return CharacterWriter(character, recording, options, glb, animation).add();
}

Json emptyAnimation(const std::string& motion) {
  return Json::Object{{"name", motion.empty() ? "rest" : motion}};
}

std::string finishGlb(const std::string& name, const std::vector<int>& roots,
                      std::vector<Json> animations, GltfBuilder& glb) {
  Json scene = Json::Object{{"nodes", numberList(roots)}};
  if (!name.empty()) scene.set("name", name);
  putMember(glb.document.json(), "scene", glb.add("scenes", std::move(scene)));
  for (Json& animation : animations)
    if (hasGltfTracks(animation)) glb.add("animations", std::move(animation));
  return glb.document.glb();
}

GlbReport writeGlb(const Character& character, const Recording& recording, const std::string& path,
                   const GlbOptions& options) {
  GltfBuilder glb(path);
  Json animation = emptyAnimation(recording.motion);
  const GltfCharacter added = addCharacter(character, recording, options, glb, animation);
  const std::string bytes =
      finishGlb(character.def().name, added.roots, {std::move(animation)}, glb);
  writeFileWhole(path, bytes);
  return {added.framesKept, bytes.size()};
}

}  // namespace fascia
