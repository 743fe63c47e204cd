#pragma once

#include <memory>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/pose/base_pose.h>
#include <fascia/pose/dents.h>
#include <fascia/pose/elastic_layer.h>
#include <fascia/pose/jiggle.h>
#include <fascia/pose/joint_volume.h>
#include <fascia/pose/limb_contact.h>
#include <fascia/pose/limb_press.h>
#include <fascia/pose/morph_shapes.h>
#include <fascia/pose/muscle_swell.h>
#include <fascia/pose/pose_mesh.h>
#include <fascia/pose/shell_nesting.h>
#include <fascia/pose/skin_spread.h>

namespace fascia {

// What a person turns, per point of the skin, each in [0, 1]. An empty list: the default.
struct PoseDials {
  static constexpr float kJiggle = 0.5f, kMuscle = 0.3f, kVolume = 0.9f, kTightness = 0.5f;
  std::vector<float> jiggle;     // flesh that moves by itself: 0 none, 0.5 as flesh is, 1 jelly
  std::vector<float> muscle;     // 0 none, 0.3 natural, 1 bodybuilder
  std::vector<float> volume;     // share of a bent joint's lost volume that comes out around it
  std::vector<float> tightness;  // how far the elastic skin evens out: 0 slack, 1 taut
  std::vector<char> rigid;       // 1: the base pose and nothing else; empty: stiffPieces()
};

// The skin of an imported figure as a function of where its joints are. Quasi-static: nothing is
// stepped, so nothing can explode and every frame can be had by itself; only the jiggle on top has
// a past. The stages, a header each:
//   base_pose       centres of rotation
//   limb_contact    limbs meet where they would pass through each other
//   elastic_layer   one prefactored solve for the skin that bends least
//   joint_volume    what a bend took away comes out around it
//   muscle_swell    flexors swell, extensors thin
//   morph_shapes    morph targets, by their weights
//   jiggle          flesh swings behind
//   dents           props press in
//   limb_press      limbs that share no crease press on each other
//   limb_contact    the last word: both sides of a crease end on one surface
//   shell_nesting   pieces that lie on each other move alike
// Constant once built, any number of threads may evaluate; same bits on any number of threads.
// Copies share everything.
class PoseSkin {
 public:
  // Scratch memory of one evaluation; grows on first use and allocates nothing after.
  struct Scratch {
    std::vector<JointMotion> joints;
    FrameArray position, turn;
    std::vector<WideRotation> rotation;
    std::vector<float> bend;   // per joint
    std::vector<float> along;  // per point
    FrameArray shown;          // of the jiggle's nodes
    Dents::Scratch dents;
    LimbContact::Scratch contact;
    LimbPress::Scratch press;
    ShellNesting::Scratch nesting;
    ElasticLayer::Scratch elastic;
  };

  // What else a frame depends on.
  struct Moment {
    double dt_s = 0;                           // since the last frame of `jiggle`, > 0
    JiggleState* jiggle = nullptr;             // takes a step; none: no jiggle
    const PoseObstacles* obstacles = nullptr;  // none: nothing stands around
    std::span<const double> morphs{};          // weights, one each; empty: all at rest
  };

  PoseSkin(const PoseSource& source, const PoseDials& dials);
  // The same figure with other dials, to the same bits as made afresh: only stages whose dial has
  // changed are made. `source` must be what `before` was made of, `dials.rigid` as it was there.
  PoseSkin(const PoseSkin& before, const PoseSource& source, const PoseDials& dials);

  std::size_t pointCount() const { return shape_->base.size(); }
  std::size_t jointCount() const { return shape_->jointCount; }
  const Jiggle& jiggle() const { return *jiggle_; }
  const PoseMesh& mesh() const { return shape_->mesh; }
  const LimbParts& parts() const { return *shape_->parts; }
  std::span<const char> rigid() const { return shape_->rigid; }
  std::size_t morphCount() const { return shape_->morphs.size(); }
  bool has(const PoseDials& dials) const;  // whether these dials change nothing

  // The skin's points, world, m, into the first pointCount() entries of `out`. `motion` per joint:
  // rest -> now, rigid.
  void evaluate(std::span<const Transform> motion, const Moment& moment, Scratch& scratch,
                VectorArray& out) const;

 private:
  // What no dial changes.
  struct Shape {
    Shape(const PoseSource& source, const std::vector<char>& rigidPoints);

    PoseMesh mesh;
    std::shared_ptr<const LimbParts> parts;
    std::size_t jointCount;
    std::vector<char> rigid;  // per point
    BasePose base;
    LimbContact contact;
    SkinSpread spread;  // read while stages are made
    LimbPress press;
    ShellNesting nesting;
    MorphShapes morphs;
  };
  void makeStages(const PoseSource& source, const PoseDials& dials, const PoseSkin* before);
  Vec3 placeJoints(std::span<const Transform> motion, Scratch& scratch) const;
  void displaceFlesh(Scratch& scratch) const;

  std::shared_ptr<const Shape> shape_;
  PoseDials dials_;  // as the stages have them: a value per point, 0 where the skin is rigid
  std::shared_ptr<const ElasticLayer> elastic_;
  std::shared_ptr<const JointVolume> volume_;
  std::shared_ptr<const MuscleSwell> muscles_;
  std::shared_ptr<const Jiggle> jiggle_;
};

}  // namespace fascia
