#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>

#include <fascia/base/parallel.h>
#include <fascia/character/character.h>

namespace fascia {
namespace {

constexpr double kFrame_s = 1.0 / 60;

// An imported limb of many bones, as `fascia flesh` fits it: per bone one solid around it and
// muscles beside it that swell as it bends, all of them tapered and bent; a tube of skin over them
// whose points hang on three bones each.
class Limb {
 public:
  static constexpr int kBones = 24, kMuscles = 3;
  static constexpr double kBone_m = 0.12, kRadius_m = 0.1;

  Limb(int around, int along) : around_(around), along_(along) {
    auto rig = std::make_shared<RiggedModel>();
    addBones(*rig);
    addSkin(*rig);
    def_.rig.emplace();
    def_.rig->model = std::move(rig);
    SkinDef& skin = def_.skin.emplace();
    skin.material.stretch_u_N_per_m = skin.material.stretch_v_N_per_m = 80;
    skin.material.shear_N_per_m = 40;
    skin.material.prestretch = 1;
    skin.fat.thickness_m = 0.05;
    skin.fat.compressible = 0.8;
    skin.tissue.stiffness_N_per_m3 = 16000;
    skin.tissue.damping_Ns_per_m3 = 300;
  }
  const CharacterDef& def() const { return def_; }

 private:
  void addBones(RiggedModel& rig) {
    for (int b = 0; b < kBones; ++b) {
      const std::string name = "bone" + std::to_string(b);
      const Vec3 offset(b > 0 ? kBone_m : 0, 0, 0);
      def_.skeleton.joints.push_back({name,
                                      b > 0 ? "bone" + std::to_string(b - 1) : "",
                                      offset,
                                      Vec3::Zero(),
                                      {{Dof::rz}, {Dof::ry}}});
      rig.joints.push_back({name, b - 1, {Mat3::Identity(), Vec3(b * kBone_m, 0, 0)}});
      for (int m = 0; m <= kMuscles; ++m) addSolid(name, m);
    }
  }
  void addSolid(const std::string& bone, int muscle) {
    FleshSolidDef solid;
    solid.name = bone + " " + std::to_string(muscle);
    solid.joint = bone;
    solid.orientation_rad = Vec3(0, kPi / 2, 0);
    const double angle = 2 * kPi * muscle / kMuscles, size = muscle > 0 ? 0.035 : 0.06;
    const double side = muscle > 0 ? 0.05 : 0;
    solid.position_m = Vec3(0.5 * kBone_m, side * std::cos(angle), side * std::sin(angle));
    solid.solid = {"superellipsoid",
                   {size, size, 0.55 * kBone_m, 0.7, 0.9},
                   {{"taper", {0.2}}, {"bend", {0.15}}}};
    for (const char* half : {"half_x_m", "half_y_m"})
      if (muscle > 0)
        solid.drivers.push_back({half, bone, Dof::rz, {{-1, 0.9 * size}, {1, 1.1 * size}}});
    def_.flesh.solids.push_back(solid);
  }
  static PointWeights weightsAt(double x_m) {
    const int bone = std::clamp(static_cast<int>(x_m / kBone_m), 0, kBones - 1);
    const double within = x_m / kBone_m - bone;  // 0 at its near end, 1 at its far end
    const int before = std::max(bone - 1, 0), after = std::min(bone + 1, kBones - 1);
    const double toBefore = 0.4 * (1 - within), toAfter = 0.4 * within;
    PointWeights w;
    w.joint = {static_cast<std::uint16_t>(bone), static_cast<std::uint16_t>(before),
               static_cast<std::uint16_t>(after)};
    w.weight = {static_cast<float>(1 - toBefore - toAfter), static_cast<float>(toBefore),
                static_cast<float>(toAfter)};
    return w;
  }
  void addSkin(RiggedModel& rig) const {
    for (int j = 0; j < along_; ++j)
      for (int i = 0; i < around_; ++i) {
        const double x = kBones * kBone_m * j / (along_ - 1), a = 2 * kPi * i / around_;
        rig.points_m.push_back(
            Vec3(x, kRadius_m * std::cos(a), kRadius_m * std::sin(a)).cast<float>());
        rig.weights.push_back(weightsAt(x));
      }
    const auto at = [&](int i, int j) {
      return static_cast<std::uint32_t>(j * around_ + i % around_);
    };
    for (int j = 0; j + 1 < along_; ++j)
      for (int i = 0; i < around_; ++i) {
        rig.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
        rig.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
      }
    rig.component.assign(rig.points_m.size(), 0);
    rig.componentCount = 1;
    for (std::uint32_t p = 0; p < rig.points_m.size(); ++p) rig.vertices.push_back({p});
    rig.drawnTriangles = rig.triangles;
  }

  CharacterDef def_;
  int around_, along_;
};

// The limb sways; the poses are the run's own, so that nothing but the layers is measured.
class Sway final : public SkinPoseSource {
 public:
  explicit Sway(const Character& character)
      : character_(character), posture_(character.skeleton().restPosture()) {}
  SkinPose at(double time_s) override {
    for (std::size_t v = 0; v < posture_.values.size(); ++v) {
      const double phase = 2 * kPi * 1.2 * time_s - 0.4 * static_cast<double>(v);
      posture_.values[v] = 0.12 * std::sin(phase);
      posture_.rates[v] = 0.12 * 2 * kPi * 1.2 * std::cos(phase);
    }
    character_.skeleton().pose(posture_, skeleton_);
    character_.flesh().pose(posture_, skeleton_, {}, flesh_);
    return {&flesh_, skeleton_.joint_world};
  }

 private:
  const Character& character_;
  Posture posture_;
  PosedSkeleton skeleton_;
  PosedFlesh flesh_;
};

// A frame of an imported character: flesh and sliding skin, without contact of the skin with
// itself.
void rigFrame(benchmark::State& state) {
  const ThreadLimit limit(static_cast<int>(state.range(2)));
  const Character character(
      Limb(static_cast<int>(state.range(0)), static_cast<int>(state.range(1))).def());
  const Skin& skin = *character.skin();
  Sway poses(character);
  SkinState skinState;
  SkinWorkspace workspace;
  SkinStats stats;
  placeSkin(skin, poses.at(0), skinState);
  int frame = 0;
  for (auto _ : state) {
    advanceSkin(skin, poses, frame * kFrame_s, (frame + 1) * kFrame_s, skinState, workspace, stats);
    ++frame;
  }
  using benchmark::Counter;
  state.counters["points"] = static_cast<double>(skin.pointCount());
  state.counters["x_real_time"] =
      Counter(static_cast<double>(state.iterations()) * kFrame_s, Counter::kIsRate);
}
BENCHMARK(rigFrame)
    ->ArgsProduct({{16}, {52}, {1}})
    ->ArgsProduct({{48}, {156}, {1, 2}})
    ->ArgsProduct({{96}, {312}, {1, 2}})
    ->UseRealTime();

// What of it goes into the pose of the joints and the flesh.
void rigPose(benchmark::State& state) {
  const Character character(Limb(16, 52).def());
  Sway poses(character);
  int frame = 0;
  for (auto _ : state) benchmark::DoNotOptimize(poses.at(++frame * kFrame_s));
}
BENCHMARK(rigPose);

}  // namespace
}  // namespace fascia
