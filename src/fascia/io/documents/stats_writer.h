#pragma once

#include <span>
#include <string>

#include <fascia/character/recording.h>
#include <fascia/world/stage_recording.h>

namespace fascia {

// How a bake went, as JSON text: vertices, simulated_s, wall_s, realtime_ratio, steps,
// rejected_steps, step_min_s, step_max_s, share_forces, share_constraints, share_other,
// max_penetration_m, max_face_depth_m (not of rigs' meshes), max_edge_stretch, peak_memory_bytes,
// state_hash, …
std::string statsJson(const Recording& recording);
void writeStats(const Recording& recording, const std::string& path);
// Of a scene: frames, simulated_s, wall_s, realtime_ratio, steps, iterations, halved_steps,
// unconverged_steps, stopped_steps, outcome, reason, sound, troubles (kind, body, with, from_s,
// to_s, depth_m or volume_left, lasts: see world/trouble.h), constraints (as below), log,
// characters (each as above), …
std::string statsJson(const Stage& stage, const StageRecording& recording);
// Constraints that say something twice or against others, a list of: kind ("redundant",
// "conflict"), constraint, with (names), rows, distance_m (of a conflict).
std::string redundanciesJson(std::span<const Redundancy> redundancies);

}  // namespace fascia
