#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include <fascia/io/rig_import/gltf/rig_from_gltf.h>

#include "gltf_sample.h"

namespace fascia::sample {

inline RiggedModel imported(const TubeRig& rig, double scale = 1) {
  return rigFromGltf(GltfDocument::parse(rig.file.glb(), "tube.glb"), {scale});
}
inline std::string complaint(const TubeRig& rig) {
  try {
    imported(rig);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

// What the header promises to everybody below.
inline void expectSound(const RiggedModel& m) {
  std::set<std::string> names;
  for (std::size_t j = 0; j < m.joints.size(); ++j) {
    EXPECT_TRUE(names.insert(m.joints[j].name).second && !m.joints[j].name.empty());
    EXPECT_LT(m.joints[j].parent, static_cast<int>(j));
    EXPECT_EQ(m.joints[j].parent < 0, j == 0);
    const Mat3& r = m.joints[j].rest_world.rotation;
    EXPECT_TRUE((r * r.transpose()).isIdentity(1e-9)) << m.joints[j].name;
    EXPECT_NEAR(r.determinant(), 1, 1e-9);
    EXPECT_TRUE(m.joints[j].rest_world.translation_m.allFinite());
  }
  ASSERT_EQ(m.points_m.size(), m.weights.size());
  ASSERT_EQ(m.points_m.size(), m.component.size());
  for (std::size_t i = 0; i < m.points_m.size(); ++i) {
    EXPECT_TRUE(m.points_m[i].allFinite());
    const PointWeights& w = m.weights[i];
    EXPECT_NEAR(std::accumulate(w.weight.begin(), w.weight.end(), 0.0), 1, 1e-5);
    EXPECT_TRUE(std::is_sorted(w.weight.rbegin(), w.weight.rend()));
    EXPECT_GE(w.weight.back(), 0);
    for (const std::uint16_t j : w.joint) EXPECT_LT(j, m.joints.size());
    EXPECT_LT(m.component[i], m.componentCount);
  }
  for (const auto& t : m.triangles) {
    for (const std::uint32_t p : t) EXPECT_LT(p, m.points_m.size());
  }
  for (const auto& t : m.drawnTriangles) {
    for (const std::uint32_t v : t) EXPECT_LT(v, m.vertices.size());
  }
  for (const RigVertex& v : m.vertices) {
    EXPECT_LT(v.point, m.points_m.size());
    EXPECT_NEAR(v.normal.norm(), 1, 1e-4);
  }
  for (const SampledMotion& motion : m.motions) {
    EXPECT_EQ(motion.joints.size(), m.joints.size());
    EXPECT_GE(motion.frameCount(), 1u);
    EXPECT_EQ(motion.rotation.size(), motion.translation_m.size());
    const std::size_t n = motion.joints.size();
    for (std::size_t i = 0; i < motion.rotation.size(); ++i) {
      EXPECT_NEAR(motion.rotation[i].norm(), 1, 1e-4);
      EXPECT_TRUE(motion.translation_m[i].allFinite());
      if (i < n) continue;
      EXPECT_GE(motion.rotation[i].dot(motion.rotation[i - n]), 0);
    }
  }
}

// Linear blend skinning of the model by a pose of its joints.
inline std::vector<Vec3> skinned(const RiggedModel& m, const std::vector<Transform>& world) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < m.points_m.size(); ++i) {
    Vec3 p = Vec3::Zero();
    for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
      const std::size_t j = m.weights[i].joint[k];
      const Transform moved = world[j] * m.joints[j].rest_world.inverse();
      p += m.weights[i].weight[k] * moved.point(m.points_m[i].cast<double>());
    }
    out.push_back(p);
  }
  return out;
}
inline double largestDistance(const std::vector<Vec3>& a, const std::vector<Eigen::Vector3f>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, (a[i] - b[i].cast<double>()).norm());
  }
  return largest;
}
inline double volume(const RiggedModel& m) {
  double six = 0;
  for (const auto& [a, b, c] : m.triangles) {
    six += m.points_m[a].cross(m.points_m[b]).dot(m.points_m[c]);
  }
  return six / 6;
}

// Valve's text format: two bones along y, a bent frame, three triangles.
inline constexpr const char* kSmd = R"(version 1
nodes
0 "hip" -1
1 "knee" 0
end
skeleton
time 0
0 0 0 0 0 0 0
1 0 1 0 0 0 0
time 1
0 0 0 0 0 0 0
1 0 1 0 0.5 0 0
end
triangles
cloth
0 0 0 0 0 0 1 0 0 1 0 1
0 1 0 0 0 0 1 1 0 1 0 1
0 1 1 0 0 0 1 1 1 2 0 0.5 1 0.5
cloth
0 0 0 0 0 0 1 0 0 1 0 1
0 1 1 0 0 0 1 1 1 2 0 0.5 1 0.5
0 0 1 0 0 0 1 0 1 2 0 0.5 1 0.5
cloth
0 0 1 0 0 0 1 0 1 2 0 0.5 1 0.5
0 1 1 0 0 0 1 1 1 2 0 0.5 1 0.5
0 1 2 0 0 0 1 1 1 1 1 1
end
)";

}  // namespace fascia::sample
