#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>
#include <fascia/motion/sampled_motion.h>

namespace fascia {

// A skinned mesh as an imported file brings it: joints, surface, weights, motions. Plain values,
// checked and repaired by the importer (what it mended stands in `notes`): everybody below may rely
// on what is said here. World space, metres, y up, in the bind pose.

struct RigJoint {
  std::string name;      // unique, not empty
  int parent = -1;       // index, smaller than this joint's own; joint 0 is the only root
  Transform rest_world;  // in the bind pose; rigid (scale is in the points)
  int node = -1;         // of the source glTF; -1: made up by the importer
};

// Influences of one point, heaviest first; unused ones have weight 0 and joint 0. Sum 1.
struct PointWeights {
  static constexpr std::size_t kMost = 8;
  std::array<std::uint16_t, kMost> joint{};
  std::array<float, kMost> weight{};
};

// A vertex as it is drawn: several share a point where the file cuts the surface (UV seams, hard
// edges, borders of materials).
struct RigVertex {
  std::uint32_t point = 0;
  Eigen::Vector3f normal{0, 1, 0};
  Eigen::Vector2f uv{0, 0};  // (0,0) = top left of the picture
};

struct RigMaterial {
  std::string name;
  std::array<float, 4> color{0.8f, 0.8f, 0.8f, 1};  // base colour factor, linear RGBA as in glTF
  float roughness = 1, metallic = 0;
  bool doubleSided = false;
  std::vector<std::uint8_t> texture;  // base colour picture, encoded PNG or JPEG; empty = none
};

// One primitive of the source: runs of vertices and triangles.
struct RigPart {
  std::string name;                          // the mesh node's
  int node = -1, mesh = -1, primitive = -1;  // in the source glTF
  int material = -1;                         // in RiggedModel::materials
  std::uint32_t firstVertex = 0, vertexCount = 0;
  std::uint32_t firstTriangle = 0, triangleCount = 0;
};

// A morph target (blend shape): moves points of the rest shape by its weight.
struct RigMorph {
  std::string name;            // unique, not empty
  int node = -1, target = -1;  // of the source glTF: the node whose weight it is, and which one
  float rest = 0;              // the weight that is in points_m
  std::vector<std::uint32_t> points;            // that it moves, increasing
  std::vector<Eigen::Vector3f> displacement_m;  // of these, for a weight of 1
};

struct RiggedModel {
  std::string name;
  std::string sourceFile;
  std::vector<RigJoint> joints;

  // The surface that is simulated: points welded by position, triangles without zero area.
  std::vector<Eigen::Vector3f> points_m;
  std::vector<PointWeights> weights;                    // per point
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of points, counter-clockwise from outside
  std::vector<std::uint32_t> component;  // per point: number of its connected piece, from 0
  std::uint32_t componentCount = 0;
  std::vector<RigMorph> morphs;  // of its points

  // The surface that is drawn and written, in the source's order.
  std::vector<RigVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> drawnTriangles;  // of vertices
  std::vector<RigPart> parts;
  std::vector<RigMaterial> materials;

  std::vector<SampledMotion> motions;  // frames of joints in their parent's; all joints
  std::vector<std::string> notes;      // what was found odd and how it was mended, for a person

  double height_m() const {  // of the bind pose; the longest side for what lies
    Box box;
    for (const Eigen::Vector3f& p : points_m) box.add(p.cast<double>());
    return box.empty() ? 0 : box.size().y();
  }
  double size_m() const {  // diagonal of the bind pose's box
    Box box;
    for (const Eigen::Vector3f& p : points_m) box.add(p.cast<double>());
    return box.empty() ? 0 : box.size().norm();
  }
};

// World frames of all joints at a time of one of the model's motions (motion -1: the bind pose).
void poseRig(const RiggedModel& model, int motion, double time_s, std::vector<Transform>& world);

}  // namespace fascia
