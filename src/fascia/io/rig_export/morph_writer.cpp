#include <algorithm>
#include <map>

#include <fascia/base/index.h>
#include <fascia/io/rig_export/baked_animation.h>
#include <fascia/io/rig_export/other_channels.h>
#include <fascia/io/rig_export/other_motions.h>
#include <fascia/io/rig_export/rig_geometry.h>
#include <fascia/io/rig_export/rig_player.h>
#include <fascia/io/rig_export/springs.h>

namespace fascia {
namespace {

std::size_t listSize(const Json* list) {
  return list && list->is(Json::Kind::list) ? list->list().size() : 0;
}

// A morph target with a value for every point, and how it turns the points' normals.
struct PointTarget {
  std::vector<Eigen::Vector3f> displacement_m;
  std::vector<Eigen::Quaternionf> turn;
};

PointTarget spread(const RiggedModel& model, const std::vector<Eigen::Vector3f>& restNormals,
                   const MorphBasis::Target& target) {
  PointTarget out;
  out.displacement_m.assign(model.points_m.size(), Eigen::Vector3f::Zero());
  std::vector<Eigen::Vector3f> moved = model.points_m, normals;
  for (std::size_t k = 0; k < target.points.size(); ++k) {
    out.displacement_m[target.points[k]] = target.displacement_m[k];
    moved[target.points[k]] += target.displacement_m[k];
  }
  computeNormals(moved, model.triangles, normals);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    out.turn.push_back(Eigen::Quaternionf::FromTwoVectors(restNormals[i], normals[i]));
  }
  return out;
}

class MorphWriter {
 public:
  MorphWriter(RigSource& source, const MorphBasis& basis)
      : source_(source), model_(source.clip.model), basis_(basis) {}

  std::vector<PlayedClip> write() {
    source_.separateMeshes();
    std::vector<BakedAnimation> animations;
    for (const RigClip& clip : source_.clips) {
      animations.push_back(prepareAnimation(source_, clip));
      leftOut_ += animations.back().leftOut;
    }
    // A mesh's weights are its node's: told by its first part.
    std::map<int, std::size_t> firstPart;
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      firstPart.emplace(model_.parts[p].node, p);
    }
    std::map<int, std::size_t> oldTargets;
    for (const auto& [node, part] : firstPart) {
      oldTargets[node] = listSize(findMember(source_.primitive(model_.parts[part]), "targets"));
    }
    if (!basis_.targets.empty()) {
      weldWeights();
      addTargets();
    }
    for (const auto& [node, part] : firstPart) {
      if (basis_.targets.empty()) break;
      nameTargets(node, oldTargets[node]);
      widenAnimations(node, oldTargets[node]);
      std::size_t first = 0;
      for (std::size_t c = 0; c < animations.size(); ++c) {
        addWeightChannel(source_, source_.clips[c], animations[c], node,
                         [&](std::size_t frame, std::vector<float>& values) {
                           const std::vector<float>& fresh = basis_.weights[first + frame];
                           values.insert(values.end(), fresh.begin(), fresh.end());
                         });
        first += source_.clips[c].recording.frames.size();
      }
    }
    std::vector<PlayedClip> played;
    for (std::size_t c = 0; c < animations.size(); ++c) {
      if (basis_.targets.empty()) addWeightChannels(source_, source_.clips[c], animations[c]);
      played.push_back({source_.clips[c], animations[c].index, animations[c].start_s});
    }
    return played;
  }

  // Channels that had to be left out.
  std::size_t leftOut() const { return leftOut_; }

 private:
  Json& meshOf(int node) {
    return source_.document.item(
        "meshes", static_cast<int>(findMember(source_.node(node), "mesh")->number()));
  }

  // Vertices that were simulated as one point, but are weighted a little differently in the file,
  // would come apart.
  void weldWeights() {
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const RigPart& part = model_.parts[p];
      const int index = source_.scene.nodes[at(part.node)].skin;
      if (index < 0 || !source_.rig.skins[at(index)].rigid) continue;
      const std::vector<int>& joints = source_.rig.skins[at(index)].joint;
      std::vector<int> slot(model_.joints.size(), -1);
      for (std::size_t i = 0; i < joints.size(); ++i) slot[at(joints[i])] = static_cast<int>(i);
      bool known = true;  // welded to another mesh, it may follow a joint that this skin lacks
      for (std::uint32_t v = part.firstVertex; v < part.firstVertex + part.vertexCount; ++v) {
        const PointWeights& w = model_.weights[model_.vertices[v].point];
        for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) {
          known = known && slot[w.joint[k]] >= 0;
        }
      }
      if (known) setWeights(source_, p, model_.weights, slot);
    }
  }

  void addTargets() {
    std::vector<Eigen::Vector3f> restNormals;
    computeNormals(model_.points_m, model_.triangles, restNormals);
    for (const MorphBasis::Target& target : basis_.targets) {
      const PointTarget points = spread(model_, restNormals, target);
      for (std::size_t p = 0; p < model_.parts.size(); ++p) addTarget(p, points);
    }
  }

  void addTarget(std::size_t p, const PointTarget& points) {
    const RigPart& part = model_.parts[p];
    const PartPlace& place = source_.places[p];
    std::vector<float> displacements(3 * std::size_t{part.vertexCount}, 0.0f),
        turns = displacements;
    const auto put = [](std::vector<float>& values, std::size_t v, const Eigen::Vector3f& value) {
      std::copy_n(value.data(), 3, &values[3 * v]);
    };
    for (std::uint32_t v = 0; v < part.vertexCount; ++v) {
      const RigVertex& vertex = model_.vertices[part.firstVertex + v];
      const Mat3 toWorld = place.of(v).linear();
      const Vec3 d = points.displacement_m[vertex.point].cast<double>();
      if (!d.isZero(0)) put(displacements, v, (toWorld.inverse() * d).cast<float>());
      const auto local = [&](const Eigen::Vector3f& normal) -> Eigen::Vector3f {
        return (toWorld.transpose() * normal.cast<double>()).normalized().cast<float>();
      };
      const Eigen::Vector3f turned = points.turn[vertex.point] * vertex.normal;
      const Eigen::Vector3f change = local(turned) - local(vertex.normal);
      if (change.norm() > kSameNormal) put(turns, v, change);
    }
    Json target{Json::Object{}};
    target.set("POSITION", source_.document.addSparseVectors(displacements, true));
    if (wantsNormals(part)) {
      target.set("NORMAL", source_.document.addSparseVectors(turns));
    }
    ensureList(source_.primitive(part), "targets").list().push_back(std::move(target));
  }

  // All targets of a primitive have the same attributes, or some viewers misread them.
  bool wantsNormals(const RigPart& part) {
    Json& primitive = source_.primitive(part);
    const Json* targets = findMember(primitive, "targets");
    if (listSize(targets) > 0) return targets->list().front().find("NORMAL") != nullptr;
    return ensureMember(primitive, "attributes").find("NORMAL") != nullptr;
  }

  void nameTargets(int node, std::size_t old) {
    Json& mesh = meshOf(node);
    widenWeights(ensureList(mesh, "weights"), old);
    if (Json* own = findMember(source_.node(node), "weights")) widenWeights(*own, old);
    Json::List& names = ensureList(ensureMember(mesh, "extras"), "targetNames").list();
    while (names.size() < old) {
      names.emplace_back(std::string("target_") + std::to_string(names.size() + 1));
    }
    names.resize(old);
    for (std::size_t k = 0; k < basis_.targets.size(); ++k) {
      const std::string digits = std::to_string(k + 1);
      names.emplace_back(std::string(k < 9 ? "fascia_morph_0" : "fascia_morph_") + digits);
    }
  }

  void widenWeights(Json& weights, std::size_t old) const {
    weights.list().resize(old, 0);
    weights.list().resize(old + basis_.targets.size(), 0);
  }

  // Other animations' keys get zeros for the new targets; keys of targets that are not there go.
  void widenAnimations(int node, std::size_t old) {
    const auto count = static_cast<int>(source_.document.root()["animations"].size());
    for (int a = 0; a < count; ++a) {
      Json::List& channels = ensureList(source_.document.item("animations", a), "channels").list();
      std::erase_if(channels, [&](Json& channel) {
        return weighsMorphs(channel, node) && !widenChannel(a, channel, old);
      });
    }
  }

  // Its own sampler, as others may share the old one. Returns false if the keys make no sense.
  bool widenChannel(int animation, Json& channel, std::size_t old) {
    const Json* index = channel.find("sampler");
    Json::List& samplers =
        ensureList(source_.document.item("animations", animation), "samplers").list();
    Json sampler = samplers.at(at(static_cast<int>(index->number())));
    const std::vector<float> keys =
        source_.document.floats(static_cast<int>(sampler.find("output")->number()), 1);
    if (old == 0 || keys.size() % old != 0) return false;
    std::vector<float> wide;
    for (std::size_t k = 0; k < keys.size(); k += old) {
      wide.insert(wide.end(), &keys[k], &keys[k] + old);
      wide.resize(wide.size() + basis_.targets.size(), 0.0f);
    }
    putMember(sampler, "output", source_.document.addFloats(wide, "SCALAR"));
    samplers.push_back(std::move(sampler));
    putMember(channel, "sampler", static_cast<int>(samplers.size()) - 1);
    return true;
  }

  // Normals that turn by less than this, in radians, are not stored.
  static constexpr float kSameNormal = 2e-3f;

  RigSource& source_;
  const RiggedModel& model_;
  const MorphBasis& basis_;
  std::size_t leftOut_ = 0;  // channels
};

}  // namespace

RigBakeReport writeRigAsMorphs(std::span<const RigClip> clips, const MorphOptions& options,
                               const std::string& path, const RigFileOptions& file) {
  RigSource source = RigSource::open(clips);
  const RiggedModel& model = source.clip.model;
  const std::vector<OtherMotion> others = otherMotions(source);
  BoneFrames bones;
  PointFrames frames;
  for (const RigClip& clip : clips) {
    for (std::vector<Transform>& pose : boneFrames(clip)) bones.push_back(std::move(pose));
    for (std::vector<Eigen::Vector3f>& frame : pointFrames(clip)) {
      frames.push_back(std::move(frame));
    }
  }
  const MorphBasis basis = findMorphBasis(model.points_m, model.weights, bones, frames, options);
  MorphWriter writer(source, basis);
  const std::vector<PlayedClip> played = writer.write();
  const std::vector<std::string> springs = settleSprings(source, file);
  source.document.writeGlb(path);
  RigBakeReport report;
  report.notes = notesOfMotions(clips, writer.leftOut());
  report.notes.insert(report.notes.end(), springs.begin(), springs.end());
  report.added = basis.targets.size();
  report.plain = basis.targets.empty();
  report.files = {path};
  measurePlayed(path, source.scale, played, report);
  report.others = measureOthers(source, path, others);
  return report;
}

}  // namespace fascia
