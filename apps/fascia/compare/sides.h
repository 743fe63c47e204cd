#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <fascia/character/recording.h>
#include <fascia/render/player.h>
#include <fascia/render/rig_joints.h>
#include <fascia/rig/blend_skinning.h>

namespace fascia {

enum class Side { plain, ours };
inline constexpr std::array<Side, 2> kSides{Side::plain, Side::ours};

// One value for each side.
template <class T>
struct Both {
  T plain{}, ours{};
  T& operator[](Side side) { return side == Side::plain ? plain : ours; }
  const T& operator[](Side side) const { return side == Side::plain ? plain : ours; }
};

// The names of the geometric skinnings that a person can ask for.
std::vector<std::string> plainSkinnings();

// A recorded character on a rig beside its plain rig: the same joints and points, with the points
// moved by weights alone. Frames are those of the recording.
class Sides {
 public:
  // Both must outlive it. `against`: one of plainSkinnings().
  Sides(const Character& character, const Recording& recording, const std::string& against);

  const Character& character() const { return character_; }
  const RiggedModel& model() const { return model_; }
  const std::string& name(Side side) const { return names_[side]; }
  std::size_t frameCount() const { return recording_.frames.size(); }
  double time_s(std::size_t frame) const { return recording_.frames[frame].time_s; }
  std::size_t closestTo(double time_s) const;

  // Where a frame's joints went from the bind pose, and the middle of them all.
  void joints(std::size_t frame, std::vector<Transform>& motion);
  Vec3 middle(std::size_t frame);
  // A frame's points, in the order of RiggedModel::points_m.
  void points(std::size_t frame, Side side, std::vector<Eigen::Vector3f>& out);

  // Goes to a frame, whose surfaces with normals and layers can then be seen.
  void seek(std::size_t frame);
  const CharacterState& state() const { return player_.state(); }
  const TriangleMesh& surface(Side side) const {
    return side == Side::plain ? plain_ : player_.skin();
  }

 private:
  const PosedSkeleton& pose(std::size_t frame);

  const Character& character_;
  const Recording& recording_;
  const RiggedModel& model_;
  Both<std::string> names_;
  std::vector<double> times_s_;
  RigJoints joints_;
  std::unique_ptr<BlendSkinning> skinning_;
  CreaseNormals creases_;
  Player player_;
  TriangleMesh plain_;
  // Of the frame last asked for.
  Posture posture_;
  PosedSkeleton posed_;
  std::vector<Transform> motion_;
  std::vector<Eigen::Vector3f> points_;
};

}  // namespace fascia
