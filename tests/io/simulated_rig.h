// Rigs with made-up simulations of them, for the tests of what is written back into their files.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fascia/io/file/file.h>
#include <fascia/io/rig_export/rig_writer.h>
#include <fascia/io/rig_import/rig_import.h>
#include <fascia/rig/linear_blend.h>
#include <fascia/rig/morph_blend.h>

#include "gltf_sample.h"
#include "sample.h"

namespace fascia::sample {

// Where a point is in the bind pose at a time, in the place of the rest.
using Bulge = std::function<Eigen::Vector3f(const Eigen::Vector3f& rest, double time_s)>;

// A rig and a made-up simulation of it: its own skinning of bulging points, and its morphs.
struct Simulated {
  RiggedModel model;
  Recording recording;
  std::vector<std::vector<Transform>> joints_world;
  std::string motion;
  double scale = 1;

  RigClip clip() const { return {model, recording, joints_world, motion, scale}; }
};

// Of the model's morphs in one of its motions (-1: at rest).
inline std::vector<double> weightsOf(const RiggedModel& model, int motion, double time_s) {
  std::vector<double> weights;
  for (const RigMorph& morph : model.morphs) {
    weights.push_back(double{morph.rest});
    if (motion < 0) continue;
    const SampledMotion& moving = model.motions.at(static_cast<std::size_t>(motion));
    for (std::size_t m = 0; m < moving.morphs.size(); ++m)
      if (moving.morphs[m] == morph.name) weights.back() = sampleWeight(moving, m, time_s);
  }
  return weights;
}

inline Simulated simulate(const std::string& path, int motion, std::size_t frames, double rate_hz,
                          const Bulge& bulge, double scale = 1) {
  Simulated out;
  out.scale = scale;
  out.model = readRiggedModel(path, RigImportOptions{scale});
  out.motion = motion < 0 ? "new" : out.model.motions.at(static_cast<std::size_t>(motion)).name;
  out.recording.frame_rate_hz = rate_hz;
  RiggedModel bulging = out.model;
  std::vector<Transform> world, moved;
  std::vector<Eigen::Vector3f> points(out.model.points_m.size());
  for (std::size_t f = 0; f < frames; ++f) {
    const double time = static_cast<double>(f) / rate_hz;
    for (std::size_t i = 0; i < points.size(); ++i) {
      bulging.points_m[i] = bulge(out.model.points_m[i], time);
    }
    poseRig(out.model, motion, time, world);
    restToFrame(out.model, world, moved);
    LinearBlend(bulging).deform(moved, points);
    Recording::Frame& frame = out.recording.frames.emplace_back();
    frame.time_s = time;
    frame.morphs = weightsOf(out.model, motion, time);
    addMorphs(out.model, frame.morphs, moved, 1, points);
    for (const RigVertex& v : out.model.vertices) frame.skin_m.push_back(points[v.point]);
    out.joints_world.push_back(world);
  }
  return out;
}

// The top of the tube sways as a whole: one helper bone, or two morph targets, can follow.
inline Eigen::Vector3f swaying(const Eigen::Vector3f& p, double time_s) {
  if (p.y() < 1.5f) return p;
  const auto s = static_cast<float>(0.1 * std::sin(6 * time_s)),
             c = static_cast<float>(0.05 * std::cos(6 * time_s));
  return p + Eigen::Vector3f(s, 0, c);
}

inline constexpr const char* kBend = "bend";
inline const std::vector<float> kTimes{0.5f, 1.f, 1.5f};
inline const std::vector<float> kTurns{0, 0, 0, 1, 0.3826834f, 0, 0, 0.9238795f, 0, 0, 0, 1};
inline const std::vector<float> kShifts{0, 0, 0, 0, 0.1f, 0, 0, 0, 0};

// The tube with two animations; the first begins at half a second.
inline TubeRig animatedTube() {
  TubeRig rig;
  rig.file.animations = "[" + rig.animation(kBend, 2, "rotation", kTimes, kTurns) + "," +
                        rig.animation("hop", 1, "translation", kTimes, kShifts) + "]";
  return rig;
}

inline std::string write(const Folder& folder, const TubeRig& rig) {
  const std::string path = folder / "rig.glb";
  writeFileWhole(path, rig.file.glb());
  return path;
}

inline GltfPlace animationOf(const GltfDocument& document, const std::string& name) {
  const GltfPlace animations = document.root()["animations"];
  for (std::size_t i = 0; i < animations.size(); ++i) {
    if (animations.at(i)["name"].textOr("") == name) return animations.at(i);
  }
  ADD_FAILURE() << name;
  return animations;
}

}  // namespace fascia::sample
