#include <fascia/io/rig_export/rig_player.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/index.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

int accessorOf(const GltfDocument& document, const GltfPlace& place) {
  return place.index(static_cast<int>(document.root()["accessors"].size()));
}

}  // namespace

RigPlayer::RigPlayer(const GltfDocument& document, std::span<const RigPart> parts, int animation,
                     double scale)
    : document_(document), scene_(GltfScene::of(document, scale, notes_)) {
  readSkins();
  for (const RigPart& part : parts) readPart(part);
  if (animation < 0) return;
  clip_ = readGltfClip(document, scene_, at(animation), notes_);
}

void RigPlayer::readSkins() {
  const GltfPlace skins = document_.root()["skins"];
  for (std::size_t s = 0; s < skins.size(); ++s) {
    Skin& skin = skins_.emplace_back();
    const GltfPlace joints = skins.at(s)["joints"];
    for (std::size_t i = 0; i < joints.size(); ++i) {
      skin.nodes.push_back(joints.at(i).index(static_cast<int>(scene_.nodes.size())));
    }
    skin.inverseBind.assign(skin.nodes.size(), Affine::Identity());
    const GltfPlace matrices = skins.at(s)["inverseBindMatrices"];
    if (!matrices) continue;
    const std::vector<float> m = document_.floats(accessorOf(document_, matrices), 16);
    for (std::size_t i = 0; i < std::min(skin.nodes.size(), m.size() / 16); ++i) {
      const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4f>(&m[16 * i]).cast<double>();
      skin.inverseBind[i].matrix() = matrix.topRows<3>();
    }
  }
}

void RigPlayer::readPart(const RigPart& source) {
  const GltfNode& node = scene_.nodes[at(source.node)];
  const GltfPlace mesh = document_.root()["meshes"].at(at(node.mesh));
  const GltfPlace primitive = mesh["primitives"].at(at(source.primitive));
  const GltfPlace attributes = primitive["attributes"];
  Part& part = parts_.emplace_back();
  part.node = source.node, part.skin = node.skin;
  const auto vectors = [&](const GltfPlace& place) {
    const std::vector<float> values = document_.floats(accessorOf(document_, place), 3);
    std::vector<Eigen::Vector3f> out(values.size() / 3);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = Eigen::Vector3f(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    }
    return out;
  };
  for (const Eigen::Vector3f& p : vectors(attributes["POSITION"])) {
    part.positions.push_back(p.cast<double>());
  }
  const GltfPlace targets = primitive["targets"];
  for (std::size_t t = 0; t < targets.size(); ++t) {
    part.targets.emplace_back();
    if (targets.at(t)["POSITION"]) part.targets.back() = vectors(targets.at(t)["POSITION"]);
  }
  part.restWeights.assign(targets.size(), 0.0f);
  const GltfPlace nodes = document_.root()["nodes"];
  const GltfPlace own = nodes.at(at(source.node))["weights"];
  const GltfPlace rest = own ? own : mesh["weights"];
  for (std::size_t t = 0; t < std::min(rest.size(), targets.size()); ++t) {
    part.restWeights[t] = static_cast<float>(rest.at(t).numberOr(0));
  }
  for (int set = 0; part.skin >= 0; ++set) {
    const GltfPlace j = attributes["JOINTS_" + std::to_string(set)];
    const GltfPlace w = attributes["WEIGHTS_" + std::to_string(set)];
    if (!j || !w) break;
    // Sets stand one after the other: set * 4 vertices + 4 vertex + influence.
    const std::vector<std::uint32_t> slots = document_.integers(accessorOf(document_, j), 4);
    const std::vector<float> weights = document_.floats(accessorOf(document_, w), 4);
    part.slots.insert(part.slots.end(), slots.begin(), slots.end());
    part.weights.insert(part.weights.end(), weights.begin(), weights.end());
  }
}

std::vector<Affine> RigPlayer::nodesAt(double time_s) const {
  std::vector<GltfNode> nodes = scene_.nodes;
  for (const GltfChannel& channel : clip_.channels) {
    std::size_t key = 0;
    const Eigen::Vector4d value = channel.valueAt(time_s, key);
    GltfNode& node = nodes[at(channel.node)];
    if (channel.path == GltfChannel::Path::translation) node.translation = value.head<3>();
    if (channel.path == GltfChannel::Path::scale) node.scale = value.head<3>();
    if (channel.path == GltfChannel::Path::rotation) node.rotation = Quat(value).normalized();
  }
  std::vector<Affine> local, world(nodes.size());
  for (const GltfNode& node : nodes) local.push_back(node.local());
  scene_.toWorld(local, scene_.order, world);
  return world;
}

std::vector<double> RigPlayer::morphWeights(std::size_t index, double time_s) const {
  const Part& part = parts_[index];
  std::vector<double> out(part.restWeights.begin(), part.restWeights.end());
  for (const GltfWeightChannel& track : clip_.weights) {
    if (track.node != part.node || track.keys.width != out.size()) continue;
    const std::vector<float> values = track.keys.valueAt(time_s);
    out.assign(values.begin(), values.end());
  }
  return out;
}

void RigPlayer::pose(double time_s, std::vector<Eigen::Vector3f>& vertices) const {
  const std::vector<Affine> world = nodesAt(time_s);
  vertices.clear();
  for (std::size_t index = 0; index < parts_.size(); ++index) {
    const Part& part = parts_[index];
    const std::vector<double> morph = morphWeights(index, time_s);
    std::vector<Affine> joints;
    if (part.skin >= 0) {
      const Skin& skin = skins_[at(part.skin)];
      for (std::size_t i = 0; i < skin.nodes.size(); ++i) {
        joints.push_back(world[at(skin.nodes[i])] * skin.inverseBind[i]);
      }
    }
    const std::size_t count = part.positions.size();
    for (std::size_t v = 0; v < count; ++v) {
      Vec3 p = part.positions[v];
      for (std::size_t t = 0; t < morph.size(); ++t) {
        if (v < part.targets[t].size()) p += morph[t] * part.targets[t][v].cast<double>();
      }
      if (part.skin < 0 || part.slots.empty()) {
        vertices.push_back((world[at(part.node)] * p).cast<float>());
        continue;
      }
      Vec3 sum = Vec3::Zero();
      for (std::size_t k = 0; k < part.slots.size(); k += 4 * count) {
        for (std::size_t i = k + 4 * v; i < k + 4 * v + 4; ++i) {
          if (part.weights[i] != 0) {
            sum += static_cast<double>(part.weights[i]) * (joints.at(part.slots[i]) * p);
          }
        }
      }
      vertices.push_back(sum.cast<float>());
    }
  }
}

namespace {

// Per frame: sums and largest of squared distances, in m².
struct FrameErrors {
  double sum_m2 = 0, largest_m2 = 0;
  double entries = 0;

  void add(const FrameErrors& other) {
    sum_m2 += other.sum_m2;
    largest_m2 = std::max(largest_m2, other.largest_m2);
    entries += other.entries;
  }
  BakeError error() const {
    return {1e3 * std::sqrt(sum_m2 / std::max(entries, 1.0)), 1e3 * std::sqrt(largest_m2)};
  }
};

FrameErrors errorsOf(const RigPlayer& player, double start_s,
                     const std::vector<Recording::Frame>& frames) {
  std::vector<FrameErrors> errors(frames.size());
  parallelFor(frames.size(), [&](std::size_t f) {
    std::vector<Eigen::Vector3f> vertices;
    player.pose(start_s + frames[f].time_s - frames.front().time_s, vertices);
    errors[f].entries = static_cast<double>(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const double e = (vertices[v] - frames[f].skin_m[v]).cast<double>().squaredNorm();
      errors[f].sum_m2 += e;
      errors[f].largest_m2 = std::max(errors[f].largest_m2, e);
    }
  });
  FrameErrors all;
  for (const FrameErrors& e : errors) all.add(e);
  return all;
}

}  // namespace

BakeError playedError(const RigPlayer& player, double start_s,
                      const std::vector<Recording::Frame>& frames) {
  return errorsOf(player, start_s, frames).error();
}

void measurePlayed(const std::string& path, double scale, std::span<const PlayedClip> played,
                   RigBakeReport& report) {
  const GltfDocument document = GltfDocument::read(path);
  FrameErrors all;
  for (const PlayedClip& p : played) {
    const RigPlayer player(document, p.clip.model.parts, p.animation, scale);
    const FrameErrors errors = errorsOf(player, p.start_s, p.clip.recording.frames);
    report.baked.push_back({p.clip.motion, errors.error()});
    all.add(errors);
  }
  report.error = all.error();
}

}  // namespace fascia
