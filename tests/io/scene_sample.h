#pragma once

#include <string>
#include <vector>

#include <fascia/io/documents/scene_file.h>

#include "gltf_sample.h"

// Scenes for the tests of their files.
namespace fascia::sample {

// Something at every key, in the form that we write. No stage can be made of it: bodies are of both
// dimensions.
inline const char* const kFullScene = R"({
  "fascia": 1,
  "kind": "scene",
  "name": "everything",
  "description": "A line \"quoted\", ünïcode.",
  "dimension": 2,
  "bodies": [
    {
      "name": "block",
      "shape": "superellipsoid",
      "basis": "quadratic",
      "density_kg_per_m3": 500,
      "rigidity_Pa": 4000,
      "volume_Pa": 8000,
      "relaxation_s": 0.01,
      "power_damping_s_per_J": 0.002,
      "drag_per_s": 0.5,
      "velocity_m_per_s": [1, 0, -1],
      "spin_deg_per_s": [0, 120.7, 0],
      "collides": false,
      "friction": 0.25,
      "scatter": {
        "position_m": [0.5, 0, 0],
        "orientation_deg": [0, 0, 45],
        "velocity_m_per_s": [0, 0.1, 0]
      },
      "points": {"top": [0, 0.2, 0], "end": [0.3, 0, 0]},
      "ornaments": [
        {
          "name": "eye",
          "shape": "sphere",
          "radius_m": 0.05,
          "position_m": [0.1, 0.2, 0.3],
          "orientation_deg": [0, 90, 0],
          "color": "#101010"
        }
      ],
      "half_x_m": 0.3,
      "position_m": [0, 1.5, 0.25],
      "orientation_deg": [0, 0, 33.3],
      "color": "#c8553d",
      "deformations": [{"type": "twist", "angle_deg": 20}]
    },
    {
      "name": "plate",
      "basis": {"lattice": [2, 1, 1]},
      "outline_m": [[0, 0], [1, 0], [0.5, 0.75]],
      "smooth_outline": true,
      "thickness_m": 0.1,
      "inflated": true
    },
    {"name": "duck", "basis": {"polynomial": 3}, "mesh": "meshes/duck.glb"}
  ],
  "places": {"hook": [0, 3, 0]},
  "constraints": [
    {
      "name": "rope",
      "type": "spring",
      "points": ["block.top", "hook"],
      "length_m": 0.5,
      "stiffness_N_per_m": 250,
      "damping_Ns_per_m": 3
    },
    {"type": "line", "points": ["plate"], "direction": [1, 0, 0]}
  ],
  "paths": [
    {
      "point": "block.end",
      "keys": [
        {"time_s": 1, "position_m": [0, 1, 0]},
        {
          "time_s": 2,
          "position_m": [1, 1, 0],
          "velocity_m_per_s": [0, -1, 0],
          "leaving_m_per_s": [0, 1, 0]
        }
      ],
      "preroll_s": 0.5
    }
  ],
  "characters": [
    {
      "name": "doll",
      "file": "doll.fascia.json",
      "motion": "sway",
      "position_m": [2, 0, 1],
      "heading_deg": 12.345,
      "friction": 0.75
    }
  ],
  "props": [
    {
      "name": "table",
      "shape": "sphere",
      "friction": 0.9,
      "radius_m": 0.4,
      "position_m": [3, 0.5, 0],
      "orientation_deg": [0, 0, 10],
      "color": "#804020"
    }
  ],
  "ground": {"height_m": -0.5, "friction": 0.8},
  "view": {"camera": "side", "low_m": [-1, 0, -1], "high_m": [1, 2, 1]},
  "script": "act.lua",
  "simulation": {
    "duration_s": 2,
    "frame_rate_hz": 30,
    "step_s": 0.005,
    "scheme": "energy",
    "gravity_m_per_s2": [0, -1.62, 0]
  }
}
)";

// One body in space, as short as it can be.
inline const char* const kSmallScene = R"({
  "fascia": 1,
  "kind": "scene",
  "name": "small",
  "bodies": [{"name": "ball", "shape": "sphere", "radius_m": 0.2}]
}
)";

// Two plates that hang on each other and a place above a floor.
inline const char* const kFlatScene = R"({
  "fascia": 1,
  "kind": "scene",
  "name": "flat",
  "dimension": 2,
  "bodies": [
    {"name": "a", "outline_m": [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]],
     "position_m": [0, 1], "points": {"low": [0, -0.1], "high": [0, 0.1]}},
    {"name": "b", "outline_m": [[0, 0], [0.3, 0.1], [0.1, 0.3]], "smooth_outline": true,
     "position_m": [0, 0.4], "points": {"tip": [0.3, 0.1]}, "basis": "quadratic"}
  ],
  "places": {"hook": [0, 2]},
  "constraints": [
    {"type": "rod", "points": ["a.high", "hook"]},
    {"type": "spring", "points": ["b.tip", "a.low"], "length_m": 0.3}
  ],
  "ground": {}
}
)";

// The corners and sides of a box around the origin, closed.
inline TriangleMesh boxMesh(const Vec3& half_m) {
  TriangleMesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner)
    mesh.positions.push_back(Vec3(corner & 1 ? half_m.x() : -half_m.x(),
                                  corner & 2 ? half_m.y() : -half_m.y(),
                                  corner & 4 ? half_m.z() : -half_m.z())
                                 .cast<float>());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// A mesh as a file that holds nothing else.
inline std::string glbOf(const TriangleMesh& mesh) {
  TinyGltf file;
  std::vector<float> positions;
  for (const Eigen::Vector3f& p : mesh.positions)
    positions.insert(positions.end(), {p.x(), p.y(), p.z()});
  std::vector<std::uint16_t> indices;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) indices.push_back(static_cast<std::uint16_t>(v));
  const std::string at = std::to_string(file.add(positions, 3, "VEC3"));
  const std::string index = std::to_string(file.add(indices, 1, "SCALAR"));
  file.nodes = R"([{"name":"box","mesh":0}])";
  file.meshes =
      R"([{"primitives":[{"attributes":{"POSITION":)" + at + R"(},"indices":)" + index + "}]}]";
  return file.glb();
}

}  // namespace fascia::sample
