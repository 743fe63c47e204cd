#pragma once

#include <vector>

#include <fascia/track/ball_joints.h>
#include <fascia/track/fade.h>

namespace fascia {

// Sources on top of each other: each layer replaces what is below it by its weight, on the joints
// and morphs that it has a share in. Below all is the rest posture. A cross-fade is two layers, of
// which the upper fades in. Joints with three rotations turn the shorter way; solid parameters that
// only one of two layers animates fade to what their drivers say.
class BlendSource final : public PostureSource {
 public:
  explicit BlendSource(const Figure& figure);

  // On top of the others; the source must outlive this one. joint_share: per joint how far the
  // layer counts there, [0, 1]; empty: 1. A solid's parameters have the share of its joint.
  // morph_share: the same per morph; empty: 1 for a layer of all joints, 0 for one of some.
  // Returns the layer's index.
  std::size_t add(const PostureSource& source, const Fade& weight = {},
                  std::vector<double> joint_share = {}, std::vector<double> morph_share = {});
  // From its weight at start_s to another, within duration_s.
  void fade(std::size_t layer, double weight, double start_s, double duration_s);
  std::size_t layerCount() const { return layers_.size(); }
  Share weight(std::size_t layer, double time_s) const { return layers_[layer].weight.at(time_s); }

  void sample(double time_s, PostureSample& out) const override;

 private:
  struct Layer {
    const PostureSource* source;
    Fade weight;
    std::vector<double> share, morphShare;  // empty: 1
  };
  void mix(const Layer& layer, const Share& weight, PostureSample& out) const;
  void mixValues(const Layer& layer, const Share& weight, Posture& out) const;
  void mixRotations(const Layer& layer, const Share& weight, Posture& out) const;
  static void mixMorphs(const Layer& layer, const Share& weight, const MorphPose& upper,
                        MorphPose& out);
  void mixParameters(const Layer& layer, const Share& weight, PostureSample& out) const;

  Figure figure_;
  BallJoints balls_;
  Posture rest_;
  std::vector<Layer> layers_;
  mutable PostureSample upper_;  // of the layer that is mixed in
  mutable std::vector<JointRotation> lowerTurns_, upperTurns_;
};

// The joints that hang below one, itself included, as a layer's shares: 1 there, 0 elsewhere.
std::vector<double> shareBelow(const Skeleton& skeleton, JointId root);

}  // namespace fascia
