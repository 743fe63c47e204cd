#pragma once

#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Declarations only: the functions are in the library.
#include <tiny_gltf.h>

#include <Eigen/Geometry>

namespace fascia::sample {

// Plays a .glb by the specification, on top of another reader than ours: nodes, morph targets and
// skins, all keys linear.
class PlayedGltf {
 public:
  explicit PlayedGltf(const std::string& path) {
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, path)) << error;
    EXPECT_EQ(error + warning, "");
  }

  int nodeNamed(const std::string& name) const {
    for (std::size_t n = 0; n < model.nodes.size(); ++n)
      if (model.nodes[n].name == name) return static_cast<int>(n);
    return -1;
  }
  const tinygltf::Animation* animationNamed(const std::string& name) const {
    for (const tinygltf::Animation& a : model.animations)
      if (a.name == name) return &a;
    return nullptr;
  }

  // Any accessor as plain numbers: sparse or not, normalised or not.
  std::vector<float> numbers(int index) const {
    const tinygltf::Accessor& accessor = model.accessors[at(index)];
    const auto width = static_cast<std::size_t>(
        tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
    std::vector<float> out(accessor.count * width, 0.0f);
    if (accessor.bufferView >= 0)
      decode(accessor.bufferView, accessor.byteOffset, accessor.componentType, accessor.normalized,
             out);
    if (!accessor.sparse.isSparse) return out;
    std::vector<float> where(static_cast<std::size_t>(accessor.sparse.count));
    std::vector<float> what(where.size() * width);
    decode(accessor.sparse.indices.bufferView, 0, accessor.sparse.indices.componentType, false,
           where);
    decode(accessor.sparse.values.bufferView, 0, accessor.componentType, accessor.normalized, what);
    for (std::size_t k = 0; k < where.size(); ++k)
      std::copy_n(&what[k * width], width, &out[static_cast<std::size_t>(where[k]) * width]);
    return out;
  }

  // World frames of all nodes at a time of an animation (nullptr: at rest).
  std::vector<Eigen::Affine3d> nodes(const tinygltf::Animation* animation, double time_s) const {
    std::vector<Eigen::Affine3d> world(model.nodes.size());
    for (const int root : model.scenes[0].nodes)
      place(root, Eigen::Affine3d::Identity(), animation, time_s, world);
    return world;
  }

  // Vertices of a node's mesh in the world.
  std::vector<Eigen::Vector3d> vertices(int node, const tinygltf::Animation* animation,
                                        double time_s) const {
    const tinygltf::Node& n = model.nodes[at(node)];
    const tinygltf::Primitive& primitive = model.meshes[at(n.mesh)].primitives[0];
    std::vector<float> points = numbers(primitive.attributes.at("POSITION"));
    std::vector<float> morph(primitive.targets.size(), 0.0f);
    key(animation, node, "weights", time_s, morph);
    for (std::size_t k = 0; k < morph.size(); ++k) {
      const std::vector<float> moved = numbers(primitive.targets[k].at("POSITION"));
      for (std::size_t i = 0; i < points.size(); ++i) points[i] += morph[k] * moved[i];
    }
    const std::vector<Eigen::Affine3d> world = nodes(animation, time_s);
    std::vector<Eigen::Affine3d> bones;
    if (n.skin >= 0) bones = bonesOf(model.skins[at(n.skin)], world);
    std::vector<Eigen::Vector3d> out;
    for (std::size_t v = 0; v < points.size() / 3; ++v) {
      const Eigen::Vector3d p =
          Eigen::Vector3f(points[3 * v], points[3 * v + 1], points[3 * v + 2]).cast<double>();
      out.push_back(n.skin < 0 ? world[at(node)] * p : p);
    }
    if (n.skin >= 0) bend(primitive, bones, out);
    return out;
  }

  tinygltf::Model model;

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  template <class T>
  static void copy(const unsigned char* from, float scale, std::vector<float>& out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      T value;
      std::memcpy(&value, from + i * sizeof(T), sizeof(T));
      out[i] = static_cast<float>(value) / scale;
    }
  }

  void decode(int view, std::size_t offset, int type, bool normalized,
              std::vector<float>& out) const {
    const tinygltf::BufferView& v = model.bufferViews[at(view)];
    const unsigned char* bytes = model.buffers[0].data.data() + v.byteOffset + offset;
    const auto scale = [&](float whole) { return normalized ? whole : 1.0f; };
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return copy<std::uint8_t>(bytes, scale(255), out);
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return copy<std::int16_t>(bytes, scale(32767), out);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return copy<std::uint16_t>(bytes, scale(65535), out);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return copy<std::uint32_t>(bytes, 1, out);
      default:
        return copy<float>(bytes, 1, out);
    }
  }

  // What an animation says of a node; leaves `value` if it says nothing.
  void key(const tinygltf::Animation* animation, int node, const std::string& path, double time_s,
           std::vector<float>& value) const {
    if (!animation) return;
    for (const tinygltf::AnimationChannel& channel : animation->channels) {
      if (channel.target_node != node || channel.target_path != path) continue;
      const tinygltf::AnimationSampler& sampler = animation->samplers[at(channel.sampler)];
      const std::vector<float> times = numbers(sampler.input), keys = numbers(sampler.output);
      std::size_t b = 0;
      while (b + 1 < times.size() && static_cast<double>(times[b]) < time_s) ++b;
      const std::size_t a = b > 0 ? b - 1 : 0, width = value.size();
      const double span = static_cast<double>(times[b]) - static_cast<double>(times[a]);
      const auto s = static_cast<float>(
          span > 0 ? std::clamp((time_s - static_cast<double>(times[a])) / span, 0.0, 1.0) : 1.0);
      for (std::size_t i = 0; i < width; ++i)
        value[i] = (1 - s) * keys[a * width + i] + s * keys[b * width + i];
    }
  }

  void place(int node, const Eigen::Affine3d& parent, const tinygltf::Animation* animation,
             double time_s, std::vector<Eigen::Affine3d>& world) const {
    const tinygltf::Node& n = model.nodes[at(node)];
    std::vector<float> t(3, 0.0f), r{0, 0, 0, 1};
    for (std::size_t i = 0; i < n.translation.size(); ++i)
      t[i] = static_cast<float>(n.translation[i]);
    for (std::size_t i = 0; i < n.rotation.size(); ++i) r[i] = static_cast<float>(n.rotation[i]);
    key(animation, node, "translation", time_s, t);
    key(animation, node, "rotation", time_s, r);
    const Eigen::Quaterniond turn =
        Eigen::Quaternionf(r[3], r[0], r[1], r[2]).cast<double>().normalized();
    world[at(node)] =
        parent * Eigen::Translation3d(Eigen::Vector3f(t[0], t[1], t[2]).cast<double>()) * turn;
    for (const int child : n.children) place(child, world[at(node)], animation, time_s, world);
  }

  std::vector<Eigen::Affine3d> bonesOf(const tinygltf::Skin& skin,
                                       const std::vector<Eigen::Affine3d>& world) const {
    const std::vector<float> matrices = numbers(skin.inverseBindMatrices);
    std::vector<Eigen::Affine3d> out;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      const Eigen::Matrix4d bind =
          Eigen::Map<const Eigen::Matrix4f>(&matrices[16 * j]).cast<double>();
      out.emplace_back(world[at(skin.joints[j])] * Eigen::Affine3d(bind));
    }
    return out;
  }

  void bend(const tinygltf::Primitive& primitive, const std::vector<Eigen::Affine3d>& bones,
            std::vector<Eigen::Vector3d>& points) const {
    std::vector<Eigen::Vector3d> sum(points.size(), Eigen::Vector3d::Zero());
    for (const std::string set : {"0", "1"}) {
      if (primitive.attributes.count("JOINTS_" + set) == 0) continue;
      const std::vector<float> joints = numbers(primitive.attributes.at("JOINTS_" + set));
      const std::vector<float> weights = numbers(primitive.attributes.at("WEIGHTS_" + set));
      for (std::size_t k = 0; k < joints.size(); ++k)
        sum[k / 4] += static_cast<double>(weights[k]) *
                      (bones[static_cast<std::size_t>(joints[k])] * points[k / 4]);
    }
    points = sum;
  }
};

}  // namespace fascia::sample
