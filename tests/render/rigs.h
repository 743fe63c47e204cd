#pragma once

#include <array>
#include <memory>

#include <fascia/rig/rigged_model.h>

// Small imported models for the tests of pictures.
namespace fascia::test {

// A cube, a metre wide, on one joint: eight points, a vertex per corner of each face, as a file
// with hard edges has it. The upper face is of the second material.
inline RiggedModel cubeModel() {
  RiggedModel model;
  model.joints.resize(1);
  model.joints[0].name = "root";
  for (int i = 0; i < 8; ++i)
    model.points_m.emplace_back(i & 1 ? 0.5f : -0.5f, i & 2 ? 1.f : 0.f, i & 4 ? 0.5f : -0.5f);
  model.weights.resize(8);
  for (PointWeights& weights : model.weights) weights.weight[0] = 1;
  model.component.assign(8, 0);
  model.componentCount = 1;
  model.materials.resize(2);
  model.materials[0].color = {0.2f, 0.4f, 0.6f, 1};
  model.materials[1].color = {1, 0, 0, 1};
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {0, 2, 3, 1}, {4, 5, 7, 6}, {2, 6, 7, 3}}};
  for (const auto& face : kFaces) {
    const auto first = static_cast<std::uint32_t>(model.vertices.size());
    const Eigen::Vector3f a = model.points_m[face[0]];
    const Eigen::Vector3f normal =
        (model.points_m[face[1]] - a).cross(model.points_m[face[2]] - a).normalized();
    for (const std::uint32_t point : face) model.vertices.push_back({point, normal, {0, 0}});
    for (const auto& t : {std::array{0u, 1u, 2u}, {0u, 2u, 3u}}) {
      model.triangles.push_back({face[t[0]], face[t[1]], face[t[2]]});
      model.drawnTriangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  model.parts = {{"box", 0, 0, 0, 0, 0, 20, 0, 10}, {"lid", 0, 0, 1, 1, 20, 4, 10, 2}};
  return model;
}

inline std::vector<Eigen::Vector3f> drawnPositions(const RiggedModel& model) {
  std::vector<Eigen::Vector3f> positions;
  for (const RigVertex& vertex : model.vertices) positions.push_back(model.points_m[vertex.point]);
  return positions;
}

}  // namespace fascia::test
