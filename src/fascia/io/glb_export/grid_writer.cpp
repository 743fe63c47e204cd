#include <fascia/io/glb_export/grid_writer.h>

#include <algorithm>
#include <set>

#include <fascia/baking/morph_normals.h>
#include <fascia/io/file/file.h>
#include <fascia/io/glb_export/character_gltf.h>
#include <fascia/io/glb_export/gltf_character_nodes.h>
#include <fascia/io/glb_export/gltf_grid_skin.h>
#include <fascia/io/glb_export/gltf_skin.h>
#include <fascia/io/glb_export/gltf_tracks.h>
#include <fascia/io/glb_export/grid_rig.h>
#include <fascia/io/gltf/gltf_animation.h>
#include <fascia/io/rig_export/rig_player.h>

namespace fascia {
namespace {

// Of the skin's size: what dropped keys of a bone may move the surface. An order below what a fit
// leaves.
constexpr double kKeyError = 1e-5;

// Segments around an ornament at most: enough for beaks and claws, and half of the bytes of 32.
constexpr int kSolidDetail = 24;

// A bone's frames in its parent's: at rest, and in all recordings one after the other.
struct BoneTrack {
  Transform rest;
  std::vector<Transform> frames;
};

class GridWriter {
 public:
  GridWriter(const Character& character, std::span<const Recording* const> recordings,
             const GridBakeOptions& options, const std::string& path)
      : character_(character),
        recordings_(recordings),
        options_(options),
        rig_(gridRigOf(character)),
        frames_(gridFramesOf(character, rig_, recordings)),
        glb_(path),
        nodes_(character, glb_) {
    for (const Recording* r : recordings) animations_.push_back(emptyAnimation(r->motion));
    Box box;
    for (const Eigen::Vector3f& p : rig_.points_m) box.add(p.cast<double>());
    size_m_ = box.size().norm();
  }

  // The whole file.
  std::string write() {
    fit();
    addJoints();
    nodes_.addSolids(character_.ornaments(), kSolidDetail);
    addHelpers();
    addSkin();
    int next = 0;
    for (const Json& animation : animations_)
      animationOf_.push_back(hasGltfTracks(animation) ? next++ : -1);
    return finishGlb(character_.def().name, nodes_.roots(), std::move(animations_), glb_);
  }

  std::size_t added() const {
    return options_.way == GridWay::bones ? skinning_.helpers.size() : basis_.targets.size();
  }
  // Of each recording: how far the written file, read back and played, is from it.
  std::vector<BakeError> errors(const std::string& path) const {
    const GltfDocument document = GltfDocument::read(path);
    RigPart part;
    part.node = skinNode_, part.primitive = 0;
    std::vector<BakeError> out;
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const RigPlayer player(document, {&part, 1}, animationOf_[r], 1);
      out.push_back(playedError(player, 0, recordings_[r]->frames));
    }
    return out;
  }

 private:
  void fit() {
    DecompositionOptions bones = options_.bones;
    for (const Recording* r : recordings_) bones.motionFrames.push_back(r->frames.size());
    // Where morph targets follow, helpers would cost more than targets that do as much.
    if (options_.way == GridWay::morphs) bones.helperBones = bones.mostHelpers = 0;
    skinning_ = decomposeSkinning(rig_.points_m, rig_.triangles, rig_.weights, frames_.bones,
                                  frames_.points, bones);
    if (options_.way == GridWay::bones) return;
    basis_ = findMorphBasis(rig_.points_m, skinning_.weights, frames_.bones, frames_.points,
                            options_.morphs);
  }

  void addJoints() {
    const Skeleton& skeleton = character_.skeleton();
    std::vector<BoneTrack> tracks;
    std::vector<Json> nodes;
    for (std::size_t j = 0; j < skeleton.jointCount(); ++j) {
      const JointId id(static_cast<std::int64_t>(j)), parent = skeleton.parent(id);
      BoneTrack& track = tracks.emplace_back();
      track.rest = parent.valid() ? rig_.rest_world[parent.index()].inverse() * rig_.rest_world[j]
                                  : rig_.rest_world[j];
      for (const std::vector<Transform>& frame : frames_.local) track.frames.push_back(frame[j]);
      nodes.push_back(nodeOf(skeleton.joint(id).name, track.rest));
      inverseBind_.push_back(matrixOf(rig_.rest_world[j].inverse()));
    }
    nodes_.addJoints(std::move(nodes));
    bones_ = nodes_.joints();
    for (std::size_t j = 0; j < tracks.size(); ++j) animate(bones_[j], tracks[j]);
  }

  static Json nodeOf(const std::string& name, const Transform& place) {
    PlaceTrack track;
    track.add(place);
    return placeNode(name, track);
  }

  static Eigen::Matrix4f matrixOf(const Transform& t) {
    Eigen::Matrix4f out = Eigen::Matrix4f::Identity();
    out.topLeftCorner<3, 3>() = t.rotation.cast<float>();
    out.topRightCorner<3, 1>() = t.translation_m.cast<float>();
    return out;
  }

  // A bone that hangs from a joint with the joint's axes: where that moves by P from its rest B,
  // its node moves by B⁻¹ P⁻¹ H X, with H its own motion and X its place at rest.
  void addHelpers() {
    std::size_t number = 0;
    for (const SkinningDecomposition::Helper& helper : skinning_.helpers) {
      const auto joint = static_cast<std::size_t>(helper.parent);
      const Transform& parent = rig_.rest_world[joint];
      const Transform place{parent.rotation, helper.center_m};
      BoneTrack track{parent.inverse() * place, {}};
      for (std::size_t f = 0; f < helper.world.size(); ++f)
        track.frames.push_back(parent.inverse() * frames_.bones[f][joint].inverse() *
                               helper.world[f] * place);
      ++number;
      const std::string name =
          std::string(number < 10 ? "fascia_helper_0" : "fascia_helper_") + std::to_string(number);
      bones_.push_back(nodes_.add(nodeOf(name, track.rest), JointId(helper.parent)));
      inverseBind_.push_back(matrixOf(place.inverse()));
      animate(bones_.back(), track);
    }
  }

  // A track in every animation, if the node moves in any of them: where players keep the pose of
  // the one before, it would stay there.
  void animate(int node, const BoneTrack& track) {
    TrackOptions keys;
    keys.metres = static_cast<float>(kKeyError * size_m_);
    keys.halfRadians = static_cast<float>(kKeyError);
    keys.small = true;
    PlaceTrack whole;
    whole.add(track.rest);
    for (const Transform& frame : track.frames) whole.add(frame);
    for (std::size_t f = 1; f < whole.rotations.size(); ++f) {
      const auto moved = [&](const auto& values, float least) {
        return (values[f] - values[0]).norm() > least;
      };
      keys.translations = keys.translations || moved(whole.translations, keys.metres);
      keys.rotations = keys.rotations || moved(whole.rotations, keys.halfRadians);
    }
    std::size_t first = 0;
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const std::size_t count = recordings_[r]->frames.size();
      PlaceTrack own;
      for (std::size_t f = first; f < first + count; ++f) own.add(track.frames[f]);
      if (keys.translations || keys.rotations)
        addTracks(timesOf(*recordings_[r]), own, node, glb_, animations_[r], keys);
      first += count;
    }
  }

  static std::vector<float> timesOf(const Recording& recording) {
    std::vector<float> times;
    for (const Recording::Frame& frame : recording.frames)
      times.push_back(static_cast<float>(frame.time_s - recording.frames.front().time_s));
    return times;
  }

  void addSkin() {
    const Texture texture = options_.texture ? *options_.texture : loadTexture(character_.def());
    GridSkinMesh skin{rig_, skinning_.weights, basis_, {}};
    if (options_.way == GridWay::morphs) {
      std::vector<Eigen::Vector3f> normals(rig_.points_m.size());
      for (std::size_t v = rig_.pointOf.size(); v-- > 0;)
        normals[rig_.pointOf[v]] = rig_.surface.normals[v];
      skin.turns = fitMorphNormals(normals, rig_.triangles, skinning_.weights, frames_.bones,
                                   frames_.points, basis_);
    }
    const int mesh =
        addGridSkin(skin, addSkinMaterial(*character_.def().skin, texture, glb_), glb_);
    const int matrices = glb_.addMatrices(inverseBind_);
    const int bind = glb_.add(
        "skins", Json::Object{{"joints", numberList(bones_)}, {"inverseBindMatrices", matrices}});
    skinNode_ =
        nodes_.add(Json::Object{{"name", "skin"}, {"mesh", mesh}, {"skin", bind}}, JointId());
    addWeights();
  }

  void addWeights() {
    if (basis_.targets.empty()) return;
    std::size_t first = 0;
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      std::vector<float> values;
      const std::size_t count = recordings_[r]->frames.size();
      for (std::size_t f = first; f < first + count; ++f)
        values.insert(values.end(), basis_.weights[f].begin(), basis_.weights[f].end());
      const int times = glb_.addTimes(timesOf(*recordings_[r]));
      addGltfTrack(animations_[r], times, glb_.addShares(values), skinNode_, "weights");
      first += count;
    }
  }

  const Character& character_;
  std::span<const Recording* const> recordings_;
  const GridBakeOptions& options_;
  GridRig rig_;
  GridFrames frames_;
  double size_m_ = 0;
  SkinningDecomposition skinning_;
  MorphBasis basis_;  // empty for GridWay::bones
  GltfBuilder glb_;
  GltfCharacterNodes nodes_;
  std::vector<Json> animations_;  // per recording
  std::vector<int> bones_;        // nodes: joints, then helpers
  std::vector<Eigen::Matrix4f> inverseBind_;
  int skinNode_ = 0;
  std::vector<int> animationOf_;  // per recording; -1: nothing moves
};

// Two animations of one name could not be told apart.
void checkNames(std::span<const Recording* const> recordings) {
  if (recordings.empty()) throw Error("there is no recording to be exported");
  std::set<std::string> names;
  for (const Recording* recording : recordings) {
    if (!names.insert(recording->motion).second)
      throw Error("the motion '" + recording->motion + "' is there twice");
  }
}

}  // namespace

GridBakeReport writeGridGlb(const Character& character,
                            std::span<const Recording* const> recordings,
                            const GridBakeOptions& options, const std::string& path) {
  checkNames(recordings);
  GridWriter writer(character, recordings, options, path);
  const std::string bytes = writer.write();
  writeFileWhole(path, bytes);
  GridBakeReport report;
  report.errors = writer.errors(path);
  report.added = writer.added();
  report.bytes = bytes.size();
  return report;
}

}  // namespace fascia
