#pragma once

#include <cmath>
#include <string>

#include <fascia/character/recording.h>
#include <fascia/io/documents/character_file.h>

namespace fascia::sample {

// The smallest character that is still one.
inline const char* const kMinimal = R"({
  "fascia": 1,
  "name": "ball",
  "skeleton": [{"name": "root"}],
  "solids": [{"name": "belly", "joint": "root", "radius_m": 0.2}],
  "skin": {"bottom": {"joint": "root"}, "top": {"joint": "root"}}
}
)";

// The smallest one whose skin is the mesh of a rig.
inline const char* const kRigged = R"({
  "fascia": 1,
  "name": "fox",
  "skeleton": [{"name": "root"}],
  "solids": [{"name": "belly", "joint": "root", "shape": "sphere", "radius_m": 0.2}],
  "rig": {"file": "meshes/fox.glb", "scale": 0.01},
  "skin": {
    "material": {"drag_Ns_per_m3": 2},
    "fat": {"thickness_m": 0.004, "compressible": 0.4, "bulk_Pa": 900},
    "tissue": {"carry": 0.5},
    "contact": {"self": true, "gap_m": 0.001},
    "parts": [{"name": "eyes"}, {"name": "ears", "rigid": false}]
  }
}
)";

// Something at almost every key, in the form that we write.
inline const char* const kFull = R"({
  "fascia": 1,
  "name": "arm",
  "description": "Two bones, \"quoted\" and ünïcode.",
  "skeleton": [
    {"name": "shoulder", "offset_m": [0, 1.25, 0], "orientation_deg": [0, 0, 30]},
    {
      "name": "elbow",
      "parent": "shoulder",
      "offset_m": [0, -0.3, 0],
      "dofs": {"rx": [-30, 120.7], "ty": {"min_m": -0.1, "max_m": 0.1, "rest_m": 0.01}, "rz": {}}
    }
  ],
  "solids": [
    {
      "name": "biceps",
      "joint": "shoulder",
      "shape": "superellipsoid",
      "half_x_m": 0.05,
      "position_m": [0, -0.15, 0.1],
      "orientation_deg": [90, 0, 12.345],
      "color": "#b84a45",
      "deformations": [{"type": "twist", "angle_deg": 33.3}],
      "drivers": [
        {
          "parameter": "half_x_m",
          "joint": "elbow",
          "dof": "rx",
          "interpolation": "piecewise",
          "points": [[0, 0.05], [120, 0.08]]
        }
      ]
    },
    {"name": "bone", "joint": "elbow", "shape": "sphere", "radius_m": 0.07},
    {
      "name": "calf",
      "joint": "elbow",
      "shape": "sphere",
      "radius_m": 0.06,
      "position_m": [0, -0.1, 0.03],
      "soft": {
        "basis": {"lattice": [2, 1, 1]},
        "density_kg_per_m3": 900,
        "held_m": [[0, 0.03, 0], [0.02, 0.03, 0.01]]
      }
    }
  ],
  "ornaments": [
    {
      "name": "watch",
      "joint": "elbow",
      "shape": "sphere",
      "radius_m": 0.01,
      "color": [0.1, 0.2, 0.3]
    }
  ],
  "skin": {
    "grid": [16, 8],
    "bottom": {"joint": "elbow", "position_m": [0, -0.1, 0]},
    "top": {"joint": "shoulder", "axis": [0, 1, 0], "radius_m": 0.01},
    "material": {"stretch_u_N_per_m": 300, "shear_N_per_m": 0},
    "fat": {"thickness_m": 0.004},
    "tissue": {"rest_length_m": 0},
    "color": "#ffcc99",
    "regions": [
      {
        "name": "inside",
        "edits": [{"quantity": "fat", "mode": "add", "value": 0.02}],
        "u": [0.8, 0.2],
        "v": [0.25, 0.75]
      }
    ],
    "brushes": [{"joint": "elbow", "center_m": [0, 0, 0.1], "amount": -0.01}],
    "anchors": [{"u": 0.5, "v": 0.5, "solid": "biceps"}],
    "points": {
      "columns": 3,
      "rows": 2,
      "prestretch": 1.1,
      "fat_m": ["0.01*2 0.012", "0.1*3"],
      "anchor_solid": ["0*3", "0 -1*2"],
      "anchor": ["0.5,0,1*3", "0,0,-1 0,0,0*2"]
    }
  },
  "motions": [
    {
      "name": "flex",
      "loop": true,
      "duration_s": 4,
      "tracks": [
        {
          "joint": "elbow",
          "dof": "rx",
          "keys": [[0, 0], [1, 10.1], {"t_s": 2, "value_deg": -10, "tension": 0.5}]
        },
        {"joint": "elbow", "dof": "ty", "keys": [{"t_s": 2, "value_m": 0.1, "bias": 1}]},
        {"solid": "bone", "parameter": "radius_m", "keys": [[0, 0.07], [4, 0.07]]},
        {"solid": "biceps", "parameter": "twist.angle_deg", "keys": [[0, 33.3]]}
      ]
    }
  ],
  "simulation": {"frame_rate_hz": 30, "integrator": "verlet", "gravity_m_per_s2": [0, -1.62, 0]}
}
)";

// A small character that can be built: what exports need beside a recording.
inline const char* const kArm = R"({
  "fascia": 1,
  "name": "arm",
  "skeleton": [
    {"name": "shoulder", "offset_m": [0, 1, 0]},
    {"name": "elbow", "parent": "shoulder", "offset_m": [0, -0.3, 0], "dofs": {"rx": [-90, 90]}}
  ],
  "solids": [
    {"name": "upper", "joint": "shoulder", "radius_m": 0.2},
    {"name": "lower", "joint": "elbow", "radius_m": 0.2}
  ],
  "ornaments": [{"name": "watch", "joint": "elbow", "radius_m": 0.01, "position_m": [0, 0, 0.2]}],
  "skin": {"grid": [16, 8], "bottom": {"joint": "elbow"}, "top": {"joint": "shoulder"}}
}
)";

// A wobbling tube of columns x rows with its seam and caps, as skinSurface lays it out.
inline Recording tube(std::size_t postureSize, int frames = 30, int columns = 16, int rows = 8) {
  Recording recording;
  recording.motion = "wobble";
  recording.frame_rate_hz = 30;
  recording.loop = true;
  const auto vertex = [&](int i, int j) {
    return static_cast<std::uint32_t>(j * (columns + 1) + i);
  };
  const auto place = [&](int i, int j, double t) {
    const double angle = 2 * kPi * (i % columns) / columns;
    const double v = static_cast<double>(j) / (rows - 1);
    const double radius = 0.3 * std::sin(kPi * (0.05 + 0.9 * v)) * (1 + 0.2 * v * std::sin(6 * t));
    return Eigen::Vector3f(static_cast<float>(radius * std::cos(angle)), static_cast<float>(v),
                           static_cast<float>(-radius * std::sin(angle)));
  };
  for (int f = 0; f < frames; ++f) {
    Recording::Frame& frame = recording.frames.emplace_back();
    frame.time_s = f / recording.frame_rate_hz;
    frame.posture.assign(postureSize, 0.01 * f);
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i <= columns; ++i) frame.skin_m.push_back(place(i, j, frame.time_s));
    }
    frame.skin_m.emplace_back(0.0f, 0.0f, 0.0f);
    frame.skin_m.emplace_back(0.0f, 1.0f, 0.0f);
  }
  TriangleMesh& mesh = recording.skin;
  mesh.positions = recording.frames.front().skin_m;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      mesh.uvs.emplace_back(static_cast<float>(i) / static_cast<float>(columns),
                            1 - static_cast<float>(j) / static_cast<float>(rows - 1));
    }
  }
  mesh.uvs.emplace_back(0.5f, 1.0f);
  mesh.uvs.emplace_back(0.5f, 0.0f);
  const auto bottom = static_cast<std::uint32_t>(mesh.positions.size() - 2), top = bottom + 1;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j + 1 < rows; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
    mesh.triangles.push_back({bottom, vertex(i + 1, 0), vertex(i, 0)});
    mesh.triangles.push_back({top, vertex(i, rows - 1), vertex(i + 1, rows - 1)});
  }
  recording.stats.steps = 100, recording.stats.rejected_steps = 3;
  recording.stats.step_min_s = 0.001, recording.stats.step_max_s = 0.02;
  recording.stats.forces_s = 3, recording.stats.constraints_s = 1;
  recording.wall_s = 0.5, recording.simulated_s = 1;
  recording.state_hash = 0x0123456789abcdefull;
  return recording;
}

// A folder that goes away with the test.
class Folder {
 public:
  Folder();
  ~Folder();
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }
  std::size_t entryCount() const;

 private:
  std::string path_;
};

// All faults of a text as "line pointer: message"; empty if it reads.
std::vector<Issue> faults(const std::string& text);

}  // namespace fascia::sample
