#include <fascia/io/rig_export/rig_source.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fascia/base/index.h>
#include <fascia/base/suggest.h>
#include <fascia/rig/blend_skinning.h>
#include <fascia/rig/morph_blend.h>

namespace fascia {
namespace {

[[noreturn]] void refuseClip(const RigClip& clip, const std::string& message,
                             const std::string& hint = {}) {
  Issue issue;
  issue.where.file = clip.model.sourceFile;
  issue.message = message;
  issue.hint = hint;
  throw Error(std::move(issue));
}

void checkClip(const RigClip& clip) {
  const auto& frames = clip.recording.frames;
  if (frames.empty() || clip.joints_world.size() != frames.size()) {
    refuseClip(clip, "the recording and the joints need the same frames, at least one");
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].skin_m.size() != clip.model.vertices.size() ||
        clip.joints_world[f].size() != clip.model.joints.size()) {
      refuseClip(clip, "the recording is of another character");
    }
    if (frames[f].morphs.size() != clip.model.morphs.size())
      refuseClip(clip, "the recording lacks the weights of the character's morphs");
    for (const double w : frames[f].morphs)
      if (!std::isfinite(w)) refuseClip(clip, "the recording has weights that are no numbers");
    for (const Eigen::Vector3f& p : frames[f].skin_m) {
      if (!p.allFinite()) refuseClip(clip, "the recording has vertices that are no numbers");
    }
    if (!std::isfinite(frames[f].time_s) || (f > 0 && frames[f].time_s <= frames[f - 1].time_s)) {
      refuseClip(clip, "the recording's times do not increase");
    }
  }
}

// A file that was edited since would get weights on the wrong vertices.
void checkUnchanged(const RigSource& source) {
  const RiggedModel& model = source.clip.model;
  const char* hint = "import it again";
  bool same = source.rig.nodeOfJoint.size() == model.joints.size();
  for (std::size_t j = 0; same && j < model.joints.size(); ++j) {
    same = model.joints[j].node == source.rig.nodeOfJoint[j];
  }
  const GltfPlace meshes = source.document.root()["meshes"];
  for (const RigPart& part : model.parts) {
    if (!same || part.node < 0 || at(part.node) >= source.scene.nodes.size() ||
        source.scene.nodes[at(part.node)].mesh != part.mesh) {
      refuseClip(source.clip, "has changed since the character was imported", hint);
    }
    const GltfPlace position =
        meshes.at(at(part.mesh))["primitives"].at(at(part.primitive))["attributes"]["POSITION"];
    const auto accessors = static_cast<int>(source.document.root()["accessors"].size());
    same = source.document.elementCount(position.index(accessors)) == part.vertexCount;
  }
  if (!same) refuseClip(source.clip, "has changed since the character was imported", hint);
}

// A blend of the skin's places, for skins whose bind poses disagree.
PartPlace bentPlace(const RigSource& source, const RigPart& part, const GltfSkin& skin) {
  const GltfDocument& document = source.document;
  const GltfPlace attributes = document.root()["meshes"].at(at(part.mesh))["primitives"].at(
      at(part.primitive))["attributes"];
  const auto accessors = static_cast<int>(document.root()["accessors"].size());
  PartPlace place;
  place.toWorld.assign(part.vertexCount, skin.whole);
  for (Affine& a : place.toWorld) a.matrix().setZero();
  std::vector<double> sum(part.vertexCount, 0.0);
  for (int set = 0; set < 4; ++set) {
    const GltfPlace j = attributes["JOINTS_" + std::to_string(set)];
    const GltfPlace w = attributes["WEIGHTS_" + std::to_string(set)];
    if (!j || !w) break;
    const std::vector<std::uint32_t> slots = document.integers(j.index(accessors), 4);
    const std::vector<float> weights = document.floats(w.index(accessors), 4);
    const std::size_t count = std::min({4 * sum.size(), slots.size(), weights.size()});
    for (std::size_t k = 0; k < count; ++k) {
      if (!(weights[k] > 0) || !std::isfinite(weights[k]) || slots[k] >= skin.toWorld.size()) {
        continue;
      }
      sum[k / 4] += weights[k];
      place.toWorld[k / 4].matrix() += weights[k] * skin.toWorld[slots[k]].matrix();
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    if (sum[v] > 0) {
      place.toWorld[v].matrix() /= sum[v];
    } else {
      place.toWorld[v] = skin.whole;
    }
  }
  return place;
}

// As MeshReader places them.
PartPlace placeOf(const RigSource& source, const RigPart& part) {
  const GltfNode& node = source.scene.nodes[at(part.node)];
  if (node.skin >= 0 && !source.rig.skins[at(node.skin)].joint.empty()) {
    const GltfSkin& skin = source.rig.skins[at(node.skin)];
    return skin.rigid ? PartPlace{{skin.whole}} : bentPlace(source, part, skin);
  }
  Affine matrix = source.scene.rest_world[at(part.node)];
  const int carrier = source.rig.carrierOfNode[at(part.node)];
  if (carrier >= 0) {
    const Affine moved =
        source.bindOfJoint(carrier) *
        source.scene.rest_world[at(source.rig.nodeOfJoint[at(carrier)])].inverse() * matrix;
    if (isSane(moved)) matrix = moved;
  }
  return {{matrix}};
}

}  // namespace

RigSource RigSource::open(std::span<const RigClip> clips) {
  assert(!clips.empty());
  const RigClip& clip = clips.front();
  for (const RigClip& c : clips) {
    assert(&c.model == &clip.model && c.scale == clip.scale);
    checkClip(c);
    for (const RigClip& before : clips) {
      if (&before == &c) break;
      if (before.motion == c.motion)
        refuseClip(c, "two motions to bake are named " + quotedName(c.motion));
    }
  }
  SourceDocument made = sourceDocumentOf(clip.model, clip.scale);
  RigSource source{clips, clip, std::move(made.document), made.scale, {}, {}, {}};
  RiggedModel scratch;  // what the importer says a second time is not needed
  source.scene = GltfScene::of(source.document, source.scale, scratch.notes);
  source.rig = GltfRig::of(source.document, source.scene, scratch);
  checkUnchanged(source);
  for (const RigPart& part : clip.model.parts) source.places.push_back(placeOf(source, part));
  return source;
}

Json& RigSource::primitive(const RigPart& part) {
  const auto mesh = static_cast<int>(findMember(node(part.node), "mesh")->number());
  return ensureList(document.item("meshes", mesh), "primitives").list().at(at(part.primitive));
}

void RigSource::separateMeshes() {
  std::vector<int> users(document.root()["meshes"].size(), 0);
  for (const GltfNode& n : scene.nodes) {
    if (n.mesh >= 0) ++users[at(n.mesh)];
  }
  int last = -1;
  for (const RigPart& part : clip.model.parts) {
    if (part.node == last || users[at(part.mesh)] < 2) continue;
    last = part.node;
    --users[at(part.mesh)];
    Json copy = document.item("meshes", part.mesh);
    putMember(node(part.node), "mesh", document.add("meshes", std::move(copy)));
  }
}

int RigSource::addTopNode(Json value) {
  const int index = document.add("nodes", std::move(value));
  if (scene.shown < 0) return index;  // files without scenes show everything
  Json& list = document.item("scenes", scene.shown);
  ensureList(list, "nodes").list().push_back(index);
  return index;
}

Affine RigSource::unit() const {
  Affine out = Affine::Identity();
  out.linear() *= scene.scale;
  return out;
}

PointFrames pointFrames(const RigClip& clip) {
  PointFrames frames;
  const BoneFrames bones = clip.model.morphs.empty() ? BoneFrames() : boneFrames(clip);
  for (const Recording::Frame& frame : clip.recording.frames) {
    const std::size_t f = frames.size();
    std::vector<Eigen::Vector3f>& points = frames.emplace_back(clip.model.points_m);
    for (std::size_t v = clip.model.vertices.size(); v-- > 0;) {
      points[clip.model.vertices[v].point] = frame.skin_m[v];
    }
    if (!bones.empty()) addMorphs(clip.model, frame.morphs, bones[f], -1, points);
  }
  return frames;
}

BoneFrames boneFrames(const RigClip& clip) {
  BoneFrames frames(clip.joints_world.size());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    restToFrame(clip.model, clip.joints_world[f], frames[f]);
  }
  return frames;
}

}  // namespace fascia
