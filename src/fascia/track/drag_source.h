#pragma once

#include <vector>

#include <fascia/track/posture_offset.h>

namespace fascia {

// A hand on a figure that something else moves: joints and morphs that are held go to where they
// are wanted, smoothly and with the speeds that they have; released they go back. What is held is
// said between frames, with times that do not go back.
class DragSource final : public PostureSource {
 public:
  // The base must outlive it. reach_s: two thirds of the way are gone after it.
  DragSource(const Figure& figure, const PostureSource& base, double reach_s = 0.1);

  // One value, metre or radian, an index into Posture::values.
  void hold(double time_s, std::size_t value, double wanted);
  // A joint's own turn, from its frame at zero angles.
  void hold(double time_s, JointId joint, const Quat& wanted);
  // A morph's weight, an index into Morphs.
  void holdMorph(double time_s, std::size_t morph, double wanted);
  void release(double time_s, JointId joint);  // all that is held of it
  void releaseMorph(double time_s, std::size_t morph);
  void releaseAll(double time_s);

  void sample(double time_s, PostureSample& out) const override;
  Info info() const override { return base_.info(); }

 private:
  struct HeldValue {
    std::size_t value;
    double wanted;
  };
  struct HeldTurn {
    JointId joint;
    Quat wanted;
  };
  void sampleGoal(double time_s, PostureSample& out) const;
  static void hold(std::vector<HeldValue>& list, std::size_t value, double wanted);
  template <class Change>
  void change(double time_s, const Change& change);

  Figure figure_;
  const PostureSource& base_;
  std::vector<HeldValue> values_;
  std::vector<HeldTurn> turns_;  // by joint
  std::vector<HeldValue> morphs_;
  PostureOffset offset_;
  PostureSample before_, after_;  // scratch
};

}  // namespace fascia
