#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include <fascia/skin/mesh/rigged_skin.h>
#include <fascia/skin/skin.h>

namespace fascia::test {

inline FleshSolidDef capsuleAlongX(const std::string& name, const std::string& joint, double from_m,
                                   double to_m, double radius_m) {
  FleshSolidDef def;
  def.name = name;
  def.joint = joint;
  def.position_m = Vec3(0.5 * (from_m + to_m), 0, 0);
  def.orientation_rad = Vec3(0, kPi / 2, 0);
  def.solid.shape = "capsule";
  def.solid.parameters = {radius_m, 0.5 * (to_m - from_m)};
  return def;
}

// An imported arm: a round mesh along x about two bones with a capsule of flesh each, the elbow at
// x = 0.3 m, and a bead above the wrist that hangs together with nothing. A third joint, "other",
// moves none of the points; it has a ball of flesh far away.
struct MeshArm {
  static constexpr double kElbow_m = 0.3, kLength_m = 0.6, kRadius_m = 0.06;
  enum Joint { upper, fore, other };

  RiggedModel rig;
  SkeletonDef skeletonDef;
  FleshDef fleshDef;
  SkinDef skinDef;
  SkinSettings settings;

  Skeleton skeleton;
  Flesh flesh;
  Diagnostics diagnostics;
  std::unique_ptr<Skin> skin;

  explicit MeshArm(int around = 24, int along = 40, bool openEnd = false) {
    const std::vector<DofDef> all{{Dof::tx}, {Dof::ty}, {Dof::tz}, {Dof::rz}};
    skeletonDef.joints = {{"upper", "", Vec3::Zero(), Vec3::Zero(), all},
                          {"fore", "upper", Vec3(kElbow_m, 0, 0), Vec3::Zero(), {{Dof::rz}}},
                          {"other", "upper", Vec3(0, 2, 0), Vec3::Zero(), all}};
    for (const JointDef& j : skeletonDef.joints)
      rig.joints.push_back({j.name, rig.joints.empty() ? -1 : 0, {Mat3::Identity(), j.offset_m}});
    FleshSolidDef ball = capsuleAlongX("ball", "other", -0.01, 0.01, 0.05);
    fleshDef.solids = {capsuleAlongX("upper", "upper", kRadius_m, kElbow_m, 0.045),
                       capsuleAlongX("fore", "fore", 0, kLength_m - kElbow_m - kRadius_m, 0.045),
                       ball};
    addArm(around, along, openEnd);
    addBead();
    rig.materials.resize(1);
    rig.materials[0].name = "glass";
    addPart("arm", -1, 0);
    addPart("bead", 0, 1);
    setSkin();
  }
  // Elastic skin on top of the pose function.
  void setSkin() {
    skinDef.tissue.stiffness_N_per_m3 = 16000;
    skinDef.tissue.damping_Ns_per_m3 = 100;
    skinDef.material.stretch_u_N_per_m = skinDef.material.stretch_v_N_per_m = 2;
    skinDef.material.shear_N_per_m = 1;
    skinDef.material.prestretch = 1;
    skinDef.fat.thickness_m = 0.05;
    skinDef.mesh.pose.simulate = true;
  }
  std::uint32_t addPoint(const Vec3& p, const PointWeights& w, std::uint32_t component) {
    rig.points_m.push_back(p.cast<float>());
    rig.weights.push_back(w);
    rig.component.push_back(component);
    rig.componentCount = component + 1;
    return static_cast<std::uint32_t>(rig.points_m.size() - 1);
  }
  static PointWeights armWeights(double x) {
    const double share = std::clamp(0.5 + (x - kElbow_m) / 0.08, 0.0, 1.0);
    const bool flip = share > 0.5;
    PointWeights w;
    w.joint = {static_cast<std::uint16_t>(flip ? fore : upper),
               static_cast<std::uint16_t>(flip ? upper : fore)};
    w.weight[0] = static_cast<float>(flip ? share : 1 - share);
    w.weight[1] = 1 - w.weight[0];
    return w;
  }
  // Rings between two poles; an open end has none at the wrist.
  void addArm(int around, int along, bool openEnd) {
    const auto ringAt = [&](int i) { return kLength_m * (0.5 - 0.5 * std::cos(kPi * i / along)); };
    const auto first = addPoint(Vec3::Zero(), armWeights(0), 0);
    for (int i = 1; i < along; ++i) {
      const double x = ringAt(i), inner = std::min({x, kLength_m - x, kRadius_m}) / kRadius_m;
      const double radius = kRadius_m * std::sqrt(inner * (2 - inner));
      for (int j = 0; j < around; ++j) {
        const double a = 2 * kPi * j / around;
        addPoint(Vec3(x, radius * std::cos(a), radius * std::sin(a)), armWeights(x), 0);
      }
    }
    const auto ring = [&](int i, int j) {
      return first + 1 + static_cast<std::uint32_t>((i - 1) * around + j % around);
    };
    for (int j = 0; j < around; ++j) {
      rig.triangles.push_back({first, ring(1, j), ring(1, j + 1)});
      for (int i = 1; i + 1 < along; ++i) {
        rig.triangles.push_back({ring(i, j), ring(i + 1, j), ring(i, j + 1)});
        rig.triangles.push_back({ring(i, j + 1), ring(i + 1, j), ring(i + 1, j + 1)});
      }
    }
    if (openEnd) return;
    const auto last = addPoint(Vec3(kLength_m, 0, 0), armWeights(kLength_m), 0);
    for (int j = 0; j < around; ++j)
      rig.triangles.push_back({last, ring(along - 1, j + 1), ring(along - 1, j)});
  }
  // An octahedron.
  void addBead() {
    PointWeights w;
    w.joint[0] = fore;
    w.weight[0] = 1;
    const auto first = static_cast<std::uint32_t>(rig.points_m.size());
    for (const Vec3& d : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      for (const double side : {1.0, -1.0})
        addPoint(Vec3(0.5, kRadius_m + 0.015, 0) + 0.006 * side * d, w, 1);
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      std::array<std::uint32_t, 3> t{first + (corner & 1), first + 2 + (corner >> 1 & 1),
                                     first + 4 + (corner >> 2)};
      if ((corner ^ corner >> 1 ^ corner >> 2) & 1) std::swap(t[0], t[1]);
      rig.triangles.push_back(t);
    }
  }
  // Draws all points of a piece.
  void addPart(const std::string& name, int material, std::uint32_t component) {
    RigPart part;
    part.name = name;
    part.material = material;
    part.firstVertex = static_cast<std::uint32_t>(rig.vertices.size());
    part.firstTriangle = static_cast<std::uint32_t>(rig.drawnTriangles.size());
    std::vector<std::uint32_t> vertexOf(rig.points_m.size());
    for (std::uint32_t p = 0; p < rig.points_m.size(); ++p) {
      if (rig.component[p] != component) continue;
      vertexOf[p] = static_cast<std::uint32_t>(rig.vertices.size());
      rig.vertices.push_back({p});
    }
    for (const auto& t : rig.triangles)
      if (rig.component[t[0]] == component)
        rig.drawnTriangles.push_back({vertexOf[t[0]], vertexOf[t[1]], vertexOf[t[2]]});
    part.vertexCount = static_cast<std::uint32_t>(rig.vertices.size()) - part.firstVertex;
    part.triangleCount = static_cast<std::uint32_t>(rig.drawnTriangles.size()) - part.firstTriangle;
    rig.parts.push_back(part);
  }

  // Returns whether the skin was built without faults.
  bool build() {
    diagnostics = {};
    skeleton = Skeleton(skeletonDef, "/skeleton", diagnostics);
    flesh = Flesh(fleshDef, skeleton, "/solids", diagnostics);
    diagnostics.throwIfErrors();
    PosedSkeleton posedSkeleton;
    PosedFlesh posedFlesh;
    skeleton.pose(skeleton.restPosture(), posedSkeleton);
    flesh.pose(skeleton.restPosture(), posedSkeleton, {}, posedFlesh);
    skin = std::make_unique<Skin>(skinDef, settings,
                                  SkinBase{skeleton, flesh, posedSkeleton, posedFlesh, &rig},
                                  "/skin", diagnostics);
    return diagnostics.ok();
  }
  double& valueOf(Posture& posture, Joint joint, Dof dof) const {
    const int index = skeleton.valueIndex(JointId(static_cast<std::int64_t>(joint)), dof);
    return posture.values[static_cast<std::size_t>(index)];
  }
};

// An arm in motion: `move` changes the rest posture into the one at a time.
class ArmRun final : public SkinPoseSource {
 public:
  using Move = std::function<void(Posture&, double time_s)>;
  static constexpr double kFrame_s = 1.0 / 60;

  ArmRun(const MeshArm& arm, Move move) : arm_(arm), move_(std::move(move)) {
    placeSkin(*arm_.skin, at(0), state);
  }

  SkinPose at(double time_s) override {
    posture_ = arm_.skeleton.restPosture();
    move_(posture_, time_s);
    // Flesh moves as fast as its way over the last moment says.
    constexpr double kMoment_s = 1e-5;
    Posture before = arm_.skeleton.restPosture();
    move_(before, time_s - kMoment_s);
    for (std::size_t i = 0; i < before.values.size(); ++i)
      posture_.rates[i] = (posture_.values[i] - before.values[i]) / kMoment_s;
    arm_.skeleton.pose(posture_, posedSkeleton);
    arm_.flesh.pose(posture_, posedSkeleton, overrides, posedFlesh);
    return {&posedFlesh, posedSkeleton.joint_world};
  }
  // Frames of a run; `each` sees the state after each of them.
  void advance(int frames, const std::function<void()>& each = {}) {
    for (int f = 0; f < frames; ++f, ++frame_) {
      advanceSkin(*arm_.skin, *this, frame_ * kFrame_s, (frame_ + 1) * kFrame_s, state, workspace,
                  stats);
      measureSkin(*arm_.skin, at((frame_ + 1) * kFrame_s), state, stats);
      if (each) each();
    }
  }
  std::uint64_t hash() const {
    StateHash hash;
    state.addTo(hash, arm_.skin->topology());
    return hash.value();
  }
  Vec3 place(std::size_t k) const {
    return {state.position.x[k], state.position.y[k], state.position.z[k]};
  }
  bool finite() const {
    bool finite = true;
    for (std::size_t k = 0; k < arm_.skin->pointCount(); ++k)
      finite = finite && place(k).allFinite();
    return finite;
  }

  SkinState state;
  SkinStats stats;
  SkinWorkspace workspace;
  PosedSkeleton posedSkeleton;
  PosedFlesh posedFlesh;
  std::vector<Flesh::ParameterOverride> overrides;

 private:
  const MeshArm& arm_;
  Move move_;
  Posture posture_;
  int frame_ = 0;
};

}  // namespace fascia::test
