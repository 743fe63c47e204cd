#include "compare/sides.h"

#include <fascia/rig/delta_mush.h>
#include <fascia/rig/dual_quaternion.h>
#include <fascia/rig/linear_blend.h>
#include <fascia/rig/morph_blend.h>

namespace fascia {
namespace {

constexpr const char* kLinear = "linear-blending";
constexpr const char* kDual = "dual-quaternions";
constexpr const char* kMush = "delta-mush";

std::unique_ptr<BlendSkinning> makeSkinning(const std::string& name, const RiggedModel& model) {
  if (name == kDual) return std::make_unique<DualQuaternionBlend>(model);
  if (name == kMush) return std::make_unique<DeltaMush>(model);
  return std::make_unique<LinearBlend>(model);
}

std::string spoken(std::string name) {
  for (char& c : name)
    if (c == '-') c = ' ';
  return name;
}

}  // namespace

std::vector<std::string> plainSkinnings() {
  return {kLinear, kDual, kMush};
}

Sides::Sides(const Character& character, const Recording& recording, const std::string& against)
    : character_(character),
      recording_(recording),
      model_(*character.def().rig->model),
      names_{spoken(against), "Fascia"},
      joints_(character),
      skinning_(makeSkinning(against, model_)),
      creases_(model_),
      player_(character, recording),
      plain_(recording.skin),
      posture_(character.skeleton().restPosture()),
      points_(model_.points_m.size()) {
  for (const Recording::Frame& frame : recording.frames) times_s_.push_back(frame.time_s);
}

std::size_t Sides::closestTo(double time_s) const {
  return closestFrame(times_s_, recording_.frame_rate_hz, time_s);
}

const PosedSkeleton& Sides::pose(std::size_t frame) {
  posture_.values = recording_.frames[frame].posture;
  character_.skeleton().pose(posture_, posed_);
  return posed_;
}

void Sides::joints(std::size_t frame, std::vector<Transform>& motion) {
  joints_.motion(pose(frame), motion);
}

Vec3 Sides::middle(std::size_t frame) {
  joints_.world(pose(frame), motion_);
  Vec3 sum = Vec3::Zero();
  for (const Transform& joint : motion_) sum += joint.translation_m;
  return sum / std::max<double>(1, static_cast<double>(motion_.size()));
}

void Sides::points(std::size_t frame, Side side, std::vector<Eigen::Vector3f>& out) {
  out.resize(model_.points_m.size());
  if (side == Side::plain) {
    joints(frame, motion_);
    skinning_->deform(motion_, out);
    addMorphs(model_, recording_.frames[frame].morphs, motion_, 1, out);
    return;
  }
  const std::vector<Eigen::Vector3f>& skin = recording_.frames[frame].skin_m;
  for (std::size_t v = 0; v < skin.size(); ++v) out[model_.vertices[v].point] = skin[v];
}

void Sides::seek(std::size_t frame) {
  player_.seek(time_s(frame));
  points(frame, Side::plain, points_);
  plain_.positions.resize(model_.vertices.size());
  for (std::size_t v = 0; v < plain_.positions.size(); ++v)
    plain_.positions[v] = points_[model_.vertices[v].point];
  creases_.compute(plain_.positions, plain_.normals);
}

}  // namespace fascia
