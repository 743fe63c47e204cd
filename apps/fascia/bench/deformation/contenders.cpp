#include "bench/deformation/contenders.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fascia/character/recording.h>
#include <fascia/rig/delta_mush.h>
#include <fascia/rig/dual_quaternion.h>
#include <fascia/rig/linear_blend.h>

#include "interrupt.h"
#include "simulation_options.h"

namespace fascia {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

class BlendContender : public Contender {
 public:
  explicit BlendContender(std::unique_ptr<BlendSkinning> skinning)
      : skinning_(std::move(skinning)) {}
  std::string name() const override { return std::string(skinning_->name()); }

  Performance perform(const Stage& stage, const Console&) override {
    Performance performance;
    const std::size_t count = stage.motions.size();
    performance.frames.assign(count, std::vector<Eigen::Vector3f>(stage.model->points_m.size()));
    std::vector<Transform> world, motion;
    const auto begin = Clock::now();
    for (std::size_t f = 0; f < count; ++f) {
      poseRig(*stage.model, 0, static_cast<double>(f) / kContestRate_hz, world);
      restToFrame(*stage.model, world, motion);
      skinning_->deform(motion, performance.frames[f]);
    }
    performance.frame_s = seconds(Clock::now() - begin) / static_cast<double>(count);
    if (interruptSignal() != 0) throw Interrupted{};
    return performance;
  }

 private:
  std::unique_ptr<BlendSkinning> skinning_;
};

class FasciaContender : public Contender {
 public:
  explicit FasciaContender(CharacterDef def) : def_(std::move(def)) {}
  std::string name() const override { return "fascia"; }

  Performance perform(const Stage& stage, const Console& console) override {
    CharacterDef def = def_;
    def.rig->model = stage.model;
    def.motions.clear();  // one of the same name would hide the rig's
    const Character character(def);
    RecordOptions options;
    options.motion = chooseMotion(character, stage.model->motions.front().name);
    options.frame_rate_hz = kContestRate_hz;
    options.duration_s = static_cast<double>(stage.motions.size() - 1) / kContestRate_hz;
    const Recording recording = simulate(character, options, console);

    // Vertices that share a point lie on one place.
    std::vector<std::uint32_t> vertexOf(stage.model->points_m.size(), 0);
    for (std::uint32_t v = 0; v < stage.model->vertices.size(); ++v)
      vertexOf[stage.model->vertices[v].point] = v;
    Performance performance;
    for (const Recording::Frame& frame : recording.frames) {
      performance.frames.emplace_back();
      for (const std::uint32_t v : vertexOf) performance.frames.back().push_back(frame.skin_m[v]);
    }
    performance.frame_s = recording.wall_s / static_cast<double>(recording.frames.size() - 1);
    return performance;
  }

 private:
  CharacterDef def_;
};

}  // namespace

Stage makeStage(const RiggedModel& model, const SampledMotion& motion, double longest_s) {
  RiggedModel copy = model;
  copy.motions = {motion};
  Stage stage{std::make_shared<const RiggedModel>(std::move(copy)), {}};
  // At least one step, or there would be nothing to simulate.
  const double duration_s = std::min(longest_s, motion.duration_s());
  const auto frames =
      std::max<std::size_t>(2, static_cast<std::size_t>(duration_s * kContestRate_hz + 0.5) + 1);
  stage.motions.resize(frames);
  std::vector<Transform> world;
  for (std::size_t f = 0; f < frames; ++f) {
    poseRig(*stage.model, 0, static_cast<double>(f) / kContestRate_hz, world);
    restToFrame(*stage.model, world, stage.motions[f]);
  }
  return stage;
}

std::vector<std::unique_ptr<Contender>> makeContenders(const RiggedModel& model,
                                                       const CharacterDef* character) {
  std::vector<std::unique_ptr<Contender>> all;
  all.push_back(std::make_unique<BlendContender>(std::make_unique<LinearBlend>(model)));
  all.push_back(std::make_unique<BlendContender>(std::make_unique<DualQuaternionBlend>(model)));
  all.push_back(std::make_unique<BlendContender>(std::make_unique<DeltaMush>(model)));
  if (character != nullptr) all.push_back(std::make_unique<FasciaContender>(*character));
  return all;
}

}  // namespace fascia
