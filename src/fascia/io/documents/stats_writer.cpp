#include <fascia/io/documents/stats_writer.h>

#include <sys/resource.h>

#include <fascia/base/hash.h>
#include <fascia/io/file/file.h>
#include <fascia/io/json/json.h>

namespace fascia {
namespace {

Json count(std::uint64_t value) {
  return Json::Number{std::to_string(value)};
}

double peakMemory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

std::string hex(std::uint64_t hash) {
  std::string out(16, '0');
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[out.size() - 1 - i] = "0123456789abcdef"[(hash >> (4 * i)) & 15u];
  }
  return out;
}

Json statsOf(const Recording& recording) {
  const SkinStats& stats = recording.stats;
  const double skin_s = stats.forces_s + stats.constraints_s + stats.other_s;
  const auto share = [&](double part_s) { return skin_s > 0 ? part_s / skin_s : 0; };
  const bool stepped = stats.steps > 0;
  Json out;
  out.set("motion", recording.motion);
  out.set("vertices", count(recording.skin.positions.size()));
  out.set("frames", count(recording.frames.size()));
  out.set("simulated_s", recording.simulated_s);
  out.set("wall_s", recording.wall_s);
  out.set("realtime_ratio", recording.wall_s > 0 ? recording.simulated_s / recording.wall_s : 0.0);
  out.set("steps", count(stats.steps));
  out.set("rejected_steps", count(stats.rejected_steps));
  out.set("step_min_s", stepped ? stats.step_min_s : 0.0);
  out.set("step_max_s", stepped ? stats.step_max_s : 0.0);
  out.set("share_forces", share(stats.forces_s));
  out.set("share_constraints", share(stats.constraints_s));
  out.set("share_other", share(stats.other_s));
  out.set("max_penetration_m", stats.max_penetration_m);
  if (stats.max_face_depth_m >= 0) out.set("max_face_depth_m", stats.max_face_depth_m);
  out.set("max_edge_stretch", stats.max_edge_stretch);
  out.set("repaired_points", count(stats.repaired_points));
  out.set("peak_memory_bytes", count(static_cast<std::uint64_t>(peakMemory_bytes())));
  out.set("state_hash", hex(recording.state_hash));
  return out;
}

Json toJson(const Stage& stage, const BodyTrouble& trouble) {
  using Kind = BodyTrouble::Kind;
  Json out;
  out.set("kind", nameOf(trouble.kind));
  out.set("body", stage.body(trouble.body).name);
  if (!trouble.with.empty()) out.set("with", trouble.with);
  out.set("from_s", trouble.from_s);
  out.set("to_s", trouble.to_s);
  if (trouble.kind == Kind::sunk || trouble.kind == Kind::inside) out.set("depth_m", trouble.worst);
  if (trouble.kind == Kind::insideOut || trouble.kind == Kind::crushed)
    out.set("volume_left", trouble.worst);
  out.set("lasts", trouble.lasts);
  return out;
}

Json redundanciesAsJson(std::span<const Redundancy> redundancies) {
  Json::List list;
  for (const Redundancy& redundancy : redundancies) {
    Json out;
    out.set("kind", redundancy.contradicts() ? "conflict" : "redundant");
    out.set("constraint", redundancy.constraint);
    Json::List with;
    for (const std::string& other : redundancy.others) with.push_back(other);
    out.set("with", std::move(with));
    out.set("rows", redundancy.row_count);
    if (redundancy.contradicts()) out.set("distance_m", redundancy.conflict_m);
    list.push_back(std::move(out));
  }
  return list;
}

}  // namespace

std::string redundanciesJson(std::span<const Redundancy> redundancies) {
  return printJson(redundanciesAsJson(redundancies));
}

std::string statsJson(const Recording& recording) {
  return printJson(statsOf(recording));
}

std::string statsJson(const Stage& stage, const StageRecording& recording) {
  constexpr const char* kOutcomes[] = {"none", "succeeded", "failed"};
  const BodyStepperStats& bodies = recording.bodies;
  Json out;
  out.set("scene", stage.def().name);
  out.set("bodies", count(stage.bodies().bodyCount()));
  out.set("coordinates", count(stage.bodies().size()));
  out.set("frames", count(recording.frames.size()));
  out.set("simulated_s", recording.simulated_s);
  out.set("wall_s", recording.wall_s);
  out.set("realtime_ratio", recording.wall_s > 0 ? recording.simulated_s / recording.wall_s : 0.0);
  out.set("steps", count(bodies.steps));
  out.set("iterations", count(bodies.iterations));
  out.set("halved_steps", count(bodies.halved));
  out.set("unconverged_steps", count(bodies.unconverged));
  out.set("stopped_steps", count(bodies.stopped));
  out.set("outcome", kOutcomes[static_cast<std::size_t>(recording.outcome)]);
  if (!recording.reason.empty()) out.set("reason", recording.reason);
  out.set("sound", !anyFault(recording.troubles));
  Json::List troubles, log, characters;
  for (const BodyTrouble& trouble : recording.troubles) troubles.push_back(toJson(stage, trouble));
  out.set("troubles", std::move(troubles));
  out.set("constraints", redundanciesAsJson(recording.redundancies));
  for (const ScriptLogLine& line : recording.log)
    log.push_back(Json::Object{{"time_s", line.time_s}, {"text", line.text}});
  for (const Recording& character : recording.characters) characters.push_back(statsOf(character));
  out.set("log", std::move(log));
  out.set("characters", std::move(characters));
  out.set("peak_memory_bytes", count(static_cast<std::uint64_t>(peakMemory_bytes())));
  out.set("state_hash", hex(recording.state_hash));
  return printJson(out);
}

void writeStats(const Recording& recording, const std::string& path) {
  writeFileWhole(path, statsJson(recording));
}

}  // namespace fascia
