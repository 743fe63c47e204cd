#include <fascia/world/joint_place.h>

namespace fascia {
namespace {

constexpr double kMoment_s = 1e-3;  // between the velocities that give an acceleration

// Poses a character for one joint's sake, and remembers the last time it was asked for.
class JointPlace {
 public:
  JointPlace(const SceneCharacterDef& def, const PostureSource& source, JointId joint)
      : character_(def.character), place_(placeOf(def)), source_(source), joint_(joint) {}

  const PathPoint& at(double time_s) {
    if (time_s == known_s_) return point_;
    known_s_ = time_s;
    const Vec3 before = velocity(time_s - kMoment_s), after = velocity(time_s + kMoment_s);
    point_.velocity_m_per_s = velocity(time_s);
    point_.position_m = place_.point(state_.skeleton.joint_world[joint_.index()].translation_m);
    point_.acceleration_m_per_s2 = (after - before) / (2 * kMoment_s);
    return point_;
  }

 private:
  Vec3 velocity(double time_s) {
    state_.time_s = time_s;
    poseLayers(*character_, source_, true, state_);
    const Twist& twist = state_.skeleton.twist_world[joint_.index()];
    return place_.vector(twist.linear_m_per_s);
  }

  std::shared_ptr<const Character> character_;
  Transform place_;
  const PostureSource& source_;
  JointId joint_;
  CharacterState state_;
  double known_s_ = -1e300;
  PathPoint point_;
};

}  // namespace

PointPath jointPlace(const SceneCharacterDef& character, const PostureSource& source,
                     JointId joint) {
  const auto place = std::make_shared<JointPlace>(character, source, joint);
  return [place](double time_s) { return place->at(time_s); };
}

}  // namespace fascia
