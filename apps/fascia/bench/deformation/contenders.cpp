#include "bench/deformation/contenders.h"

#include <algorithm>
#include <ctime>

#include <fascia/character/character.h>
#include <fascia/rig/delta_mush.h>
#include <fascia/rig/dual_quaternion.h>
#include <fascia/rig/linear_blend.h>

#include "progress.h"
#include "simulation_options.h"

namespace fascia {
namespace {

// Processor time of this thread: what else the machine does would spoil the clock on the wall.
class Stopwatch {
 public:
  void start() { begin_s_ = now_s(); }
  void stop() { total_s_ += now_s() - begin_s_; }
  double total_s() const { return total_s_; }

 private:
  static double now_s() {
    std::timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double begin_s_ = 0, total_s_ = 0;
};

class BlendContender : public Contender {
 public:
  explicit BlendContender(std::unique_ptr<BlendSkinning> skinning)
      : skinning_(std::move(skinning)) {}
  std::string name() const override { return std::string(skinning_->name()); }

  ContestFrames perform(const ContestStage& stage, const Console&) override {
    ContestFrames performance;
    const std::size_t count = stage.motions.size();
    performance.frames.assign(count, std::vector<Eigen::Vector3f>(stage.model->points_m.size()));
    std::vector<Transform> world, motion;
    Stopwatch watch;
    watch.start();
    for (std::size_t f = 0; f < count; ++f) {
      poseRig(*stage.model, stage.motion, static_cast<double>(f) / kContestRate_hz, world);
      restToFrame(*stage.model, world, motion);
      skinning_->deform(motion, performance.frames[f]);
    }
    watch.stop();
    performance.frame_s = watch.total_s() / static_cast<double>(count);
    return performance;
  }

 private:
  std::unique_ptr<BlendSkinning> skinning_;
};

// How much a Fascia that may jiggle may tremble beside linear blending.
constexpr double kJitterOfJiggle = 2.5, kJitterOfStill = 1.3;

// The surface that a character shows, vertex by vertex.
void showCharacter(const Character& character, const CharacterState& state, TriangleMesh& surface) {
  skinSurface(*character.skin(), state.flesh, state.skin, surface);
}

class FasciaContender : public Contender {
 public:
  FasciaContender(std::string name, std::shared_ptr<const RiggedModel> model, CharacterDef def,
                  double jitterGoal, const BuildOptions& options = {})
      : name_(std::move(name)),
        jitterGoal_(jitterGoal),
        model_(std::move(model)),
        character_(onModel(model_, std::move(def)), options) {
    if (!character_.skin()) throw Error("the character has no skin to compare");
    // Vertices that share a point lie on one place.
    vertexOf_.resize(model_->points_m.size(), 0);
    for (std::uint32_t v = 0; v < model_->vertices.size(); ++v)
      vertexOf_[model_->vertices[v].point] = v;
  }
  std::string name() const override { return name_; }
  double jitterGoal() const override { return jitterGoal_; }

  ContestFrames perform(const ContestStage& stage, const Console& console) override {
    const std::size_t rigMotion = static_cast<std::size_t>(stage.motion);
    const int motion = chooseMotion(character_, model_->motions[rigMotion].name);
    ContestFrames performance;
    CharacterState state = initialState(character_, character_.source(motion));
    SkinStats stats;
    Stopwatch watch;
    TriangleMesh surface;
    ProgressBar progress(console, "simulating");
    for (std::size_t f = 0; f < stage.motions.size(); ++f) {
      if (f > 0) {
        watch.start();
        advance(character_, character_.source(motion), 1 / kContestRate_hz, state, stats);
        watch.stop();
      }
      showCharacter(character_, state, surface);
      performance.frames.emplace_back();
      for (const std::uint32_t v : vertexOf_)
        performance.frames.back().push_back(surface.positions[v]);
      const auto done = static_cast<double>(f + 1);
      progress.update(done / static_cast<double>(stage.motions.size()));
    }
    performance.frame_s = watch.total_s() / static_cast<double>(stage.motions.size() - 1);
    return performance;
  }

 private:
  static CharacterDef onModel(std::shared_ptr<const RiggedModel> model, CharacterDef def) {
    def.rig->model = std::move(model);
    def.motions.clear();  // one of the same name would hide the rig's
    return def;
  }

  std::string name_;
  double jitterGoal_;
  std::shared_ptr<const RiggedModel> model_;
  Character character_;
  std::vector<std::uint32_t> vertexOf_;  // of a point
};

}  // namespace

ContestStage makeContestStage(std::shared_ptr<const RiggedModel> model, int motion,
                              double longest_s) {
  ContestStage stage{std::move(model), motion, {}};
  const SampledMotion& shown = stage.model->motions[static_cast<std::size_t>(motion)];
  // At least one step, or there would be nothing to simulate.
  const double duration_s = std::min(longest_s, shown.duration_s());
  const auto frames = static_cast<std::size_t>(
      std::max<long long>(2, std::llround(duration_s * kContestRate_hz) + 1));
  stage.motions.resize(frames);
  std::vector<Transform> world;
  for (std::size_t f = 0; f < frames; ++f) {
    poseRig(*stage.model, motion, static_cast<double>(f) / kContestRate_hz, world);
    restToFrame(*stage.model, world, stage.motions[f]);
  }
  return stage;
}

std::vector<std::unique_ptr<Contender>> makeContenders(std::shared_ptr<const RiggedModel> model,
                                                       const CharacterDef* character) {
  std::vector<std::unique_ptr<Contender>> all;
  all.push_back(std::make_unique<BlendContender>(std::make_unique<LinearBlend>(*model)));
  all.push_back(std::make_unique<BlendContender>(std::make_unique<DualQuaternionBlend>(*model)));
  all.push_back(std::make_unique<BlendContender>(std::make_unique<DeltaMush>(*model)));
  if (character == nullptr) return all;
  all.push_back(std::make_unique<FasciaContender>("fascia", model, *character, kJitterOfJiggle));
  BuildOptions still;
  still.jiggle = 0;
  all.push_back(
      std::make_unique<FasciaContender>("fascia, still", model, *character, kJitterOfStill, still));
  return all;
}

}  // namespace fascia
