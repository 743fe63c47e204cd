#include <fascia/rig/retarget.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fascia/base/assert.h>
#include <fascia/base/error.h>
#include <fascia/base/index.h>
#include <fascia/base/suggest.h>
#include <fascia/rig/retarget_legs.h>
#include <fascia/rig/retarget_rest.h>

namespace fascia {
namespace {

// Above this the file's rest pose is no stance, and a first frame that is one is taken instead.
constexpr double kNoStance_rad = radians(12);
// A foot that moves slower stands. Larger: swinging feet count; smaller: noise hides standing ones.
constexpr double kStanding_legs_per_s = 0.15;

std::vector<DrivenJoint> drivenJoints(const MotionFigure& source, const RiggedModel& target,
                                      const JointMap& map, std::span<const JointMeaning> meanings) {
  std::unordered_map<std::string, int> sources, targets;
  for (std::size_t j = 0; j < source.joints.size(); ++j) {
    sources.emplace(source.joints[j].name, static_cast<int>(j));
  }
  std::vector<int> sourceOf(target.joints.size(), -1);
  for (std::size_t j = 0; j < target.joints.size(); ++j) {
    targets.emplace(target.joints[j].name, static_cast<int>(j));
  }
  for (const JointPair& pair : map) {
    const auto s = sources.find(pair.source), t = targets.find(pair.target);
    if (s != sources.end() && t != targets.end()) sourceOf[at(t->second)] = s->second;
  }
  std::vector<DrivenJoint> driven;
  std::vector<int> drivenOf(target.joints.size(), -1);  // the nearest driven one, itself included
  for (std::size_t j = 0; j < target.joints.size(); ++j) {
    const int parent = target.joints[j].parent;
    const int above = parent < 0 ? -1 : drivenOf[at(parent)];
    drivenOf[j] = above;
    if (sourceOf[j] < 0) continue;
    DrivenJoint d;
    d.source = sourceOf[j];
    d.target = static_cast<int>(j);
    d.above = above;
    d.meaning = meanings[j];
    if (above >= 0 && driven[at(above)].source == d.source) {
      d.inRun = driven[at(above)].inRun + 1;
      d.run = d.inRun + 1;
      for (int k = above, n = 0; n < d.inRun; ++n, k = driven[at(k)].above)
        driven[at(k)].run = d.run;
    }
    drivenOf[j] = static_cast<int>(driven.size());
    driven.push_back(d);
  }
  return driven;
}

// The turn about an axis that is part of a rotation (swing-twist decomposition).
Quat twistAbout(const Quat& rotation, const Vec3& axis) {
  FASCIA_ASSERT(isUnit(axis), "one turns about a direction");
  const Vec3 along = axis * rotation.vec().dot(axis);
  const Quat twist(rotation.w(), along.x(), along.y(), along.z());
  return twist.norm() < 1e-9 ? Quat::Identity() : twist.normalized();
}

class Retargeter {
 public:
  Retargeter(const MotionFigure& source, const RiggedModel& target, const JointMap& map,
             const RetargetOptions& options, std::vector<std::string>* notes)
      : source_(source),
        target_(target),
        options_(options),
        notes_(notes),
        sourceMeanings_(guessMeanings(source.joints, options.sourceSaid)),
        targetMeanings_(guessMeanings(target.joints, options.said)),
        driven_(drivenJoints(source, target, map, targetMeanings_)) {
    if (driven_.empty()) {
      throw Error("no joint of the rig is driven by the motion: give a joint map");
    }
    root_ = static_cast<int>(
        std::find_if(driven_.begin(), driven_.end(),
                     [](const DrivenJoint& d) { return d.meaning.part == BodyPart::hips; }) -
        driven_.begin());
    if (at(root_) == driven_.size()) root_ = 0;
    if (options.plantFeet) legs_ = legsOf(driven_);
    chooseRest();
    measure();
  }

  SampledMotion run() {
    SampledMotion out;
    out.name = source_.motion.name;
    out.rate_hz = source_.motion.rate_hz;
    out.loop = source_.motion.loop;
    for (const RigJoint& joint : target_.joints) out.joints.push_back(joint.name);
    const std::size_t frames = source_.motion.frameCount() - firstFrame_;
    out.rotation.reserve(frames * target_.joints.size());
    out.translation_m.reserve(frames * target_.joints.size());
    settleStart();
    for (std::size_t f = 0; f < frames; ++f) {
      poseFrame(f + firstFrame_);
      append(out);
    }
    return out;
  }

 private:
  void chooseRest();
  void measure();
  void settleStart();
  void poseFrame(std::size_t frame);
  void turnDriven();
  void placeJoints();
  void plantFeet();
  void append(SampledMotion& out) const;
  std::vector<double> standingHeights();
  double legLength(std::span<const Transform> world, bool ofTarget) const;
  Vec3 rootGoal() const;
  Vec3 ballGoal(const DrivenLeg& leg, std::size_t which) const;
  Mat3 delta(int driven) const;
  void note(std::string_view text) const {
    if (notes_) notes_->emplace_back(text);
  }
  const Transform& source(int driven) const { return sourceWorld_[at(driven_[at(driven)].source)]; }
  const Transform& target(int driven) const { return world_[at(driven_[at(driven)].target)]; }

  const MotionFigure& source_;
  const RiggedModel& target_;
  RetargetOptions options_;
  std::vector<std::string>* notes_;
  std::vector<JointMeaning> sourceMeanings_, targetMeanings_;
  std::vector<DrivenJoint> driven_;
  std::vector<DrivenLeg> legs_;
  int root_ = 0;                // of driven_: carries the path
  std::size_t firstFrame_ = 0;  // of the source that is kept

  std::vector<Transform> sourceRest_, targetRest_, restLocal_;
  RestAlignment rest_;
  Mat3 axes_ = Mat3::Identity();  // of the rig: left, up, forward
  double scale_ = 1;
  Vec3 start_m_ = Vec3::Zero();   // added to the scaled path
  std::vector<Vec3> ballOffset_;  // per leg: the same of the planted joint

  // Of the frame at hand.
  std::vector<Transform> sourceWorld_, world_;
  std::vector<Mat3> deltas_;    // per driven joint: turn in the world since the rest pose
  std::vector<bool> isTurned_;  // per target joint
};

void Retargeter::chooseRest() {
  for (const RigJoint& joint : source_.joints) sourceRest_.push_back(joint.rest_world);
  for (const RigJoint& joint : target_.joints) targetRest_.push_back(joint.rest_world);
  bool first = options_.rest == SourceRest::firstFrame;
  poseFigure(source_, 0, sourceWorld_);
  if (options_.rest == SourceRest::automatic && source_.motion.frameCount() > 1) {
    const double bind = stanceError_rad(sourceRest_, sourceMeanings_);
    first = bind > kNoStance_rad && stanceError_rad(sourceWorld_, sourceMeanings_) < 0.6 * bind;
    if (first) {
      firstFrame_ = 1;
      note("the first frame is a calibration stance: it is taken as the rest pose and left out");
    }
  }
  if (first) sourceRest_ = sourceWorld_;
  for (std::size_t j = 0; j < target_.joints.size(); ++j) {
    const int parent = target_.joints[j].parent;
    restLocal_.push_back(parent < 0 ? targetRest_[j]
                                    : targetRest_[at(parent)].inverse() * targetRest_[j]);
  }
}

double Retargeter::legLength(std::span<const Transform> world, bool ofTarget) const {
  const std::vector<DrivenLeg> legs = legsOf(driven_);
  const auto place = [&](int d) {
    return world[at(ofTarget ? driven_[at(d)].target : driven_[at(d)].source)].translation_m;
  };
  double length = 0;
  for (const DrivenLeg& leg : legs) {
    const Vec3 hip = place(leg.upper.front()), knee = place(leg.lower.front());
    length += (knee - hip).norm() + (place(leg.foot) - knee).norm();
  }
  return length;
}

// The path's scale: by the legs, which carry it; without legs by the whole figure.
void Retargeter::measure() {
  rest_ = alignRest(driven_, sourceRest_, sourceMeanings_, targetRest_, targetMeanings_);
  axes_ = figureAxes(targetRest_, targetMeanings_);
  double from = legLength(sourceRest_, false), to = legLength(targetRest_, true);
  if (from <= 0 || to <= 0) {
    Box sourceBox, targetBox;
    for (const DrivenJoint& d : driven_) {
      sourceBox.add(sourceRest_[at(d.source)].translation_m);
      targetBox.add(targetRest_[at(d.target)].translation_m);
    }
    from = sourceBox.size().norm(), to = targetBox.size().norm();
  }
  if (from > 0 && to > 0) scale_ = to / from;
  note("lengths of the path are scaled by " + shortNumber(scale_));

  // The rest pose with limbs aligned: how the figures differ in build, not in posture.
  world_.assign(target_.joints.size(), Transform());
  deltas_.assign(driven_.size(), Mat3::Identity());
  sourceWorld_ = sourceRest_;
  turnDriven();
  placeJoints();
  for (const DrivenLeg& leg : legs_) {
    const Vec3 recorded =
        rest_.toTarget * (source(leg.planted).translation_m - source(root_).translation_m);
    ballOffset_.push_back(target(leg.planted).translation_m - target(root_).translation_m -
                          scale_ * recorded);
  }
}

Vec3 Retargeter::rootGoal() const {
  return scale_ * (rest_.toTarget * source(root_).translation_m) + start_m_;
}

Mat3 Retargeter::delta(int driven) const {
  const int s = driven_[at(driven)].source;
  return rest_.toTarget * sourceWorld_[at(s)].rotation * sourceRest_[at(s)].rotation.transpose() *
         rest_.toTarget.transpose();
}

// Turns of all driven joints since the rest pose. Joints that share a source share its turn: a
// trunk bends evenly, a limb stays straight and twists evenly.
void Retargeter::turnDriven() {
  for (std::size_t d = 0; d < driven_.size(); ++d) {
    const DrivenJoint& joint = driven_[d];
    deltas_[d] = delta(static_cast<int>(d));
    if (joint.run == 1) continue;
    int before = static_cast<int>(d);
    for (int k = 0; k <= joint.inRun; ++k) before = driven_[at(before)].above;
    const Quat base(before < 0 ? Mat3::Identity().eval() : deltas_[at(before)]);
    const Quat turn = base.conjugate() * Quat(deltas_[d]);
    const double share = (joint.inRun + 1.0) / joint.run;
    Quat part = Quat::Identity().slerp(share, turn);
    if (!isTrunk(joint.meaning.part) && rest_.axis[d].norm() > 0) {
      const Quat twist = twistAbout(turn, rest_.axis[d].normalized());
      part = turn * twist.conjugate() * Quat::Identity().slerp(share, twist);
    }
    deltas_[d] = (base * part).normalized().toRotationMatrix();
  }
  isTurned_.assign(target_.joints.size(), false);
  for (std::size_t d = 0; d < driven_.size(); ++d) {
    const std::size_t j = at(driven_[d].target);
    world_[j].rotation = deltas_[d] * rest_.turn[d] * targetRest_[j].rotation;
    isTurned_[j] = true;
  }
}

// World frames from the rotations of driven joints: the others keep their place on their parents.
void Retargeter::placeJoints() {
  for (std::size_t j = 0; j < target_.joints.size(); ++j) {
    const int parent = target_.joints[j].parent;
    const Transform whole = parent < 0 ? restLocal_[j] : world_[at(parent)] * restLocal_[j];
    if (!isTurned_[j]) world_[j].rotation = whole.rotation;
    world_[j].translation_m = whole.translation_m;
    if (j == at(driven_[at(root_)].target)) world_[j].translation_m = rootGoal();
  }
}

Vec3 Retargeter::ballGoal(const DrivenLeg& leg, std::size_t which) const {
  // The offset turns with the foot's heading, so that a standing foot's goal stands.
  Vec3 forward = deltas_[at(leg.foot)] * axes_.col(2);
  forward.y() = 0;
  const Mat3 heading = shortestArc(axes_.col(2), forward);
  return scale_ * (rest_.toTarget * source(leg.planted).translation_m) + start_m_ +
         heading * ballOffset_[which];
}

void Retargeter::plantFeet() {
  for (std::size_t l = 0; l < legs_.size(); ++l) {
    const DrivenLeg& leg = legs_[l];
    const Vec3 ankle = target(leg.foot).translation_m;
    const Vec3 goal = ballGoal(leg, l) - (target(leg.planted).translation_m - ankle);
    const Vec3 kneeAxis = deltas_[at(leg.lower.front())] * axes_.col(0);
    const LegTurns turns = reach(target(leg.upper.front()).translation_m,
                                 target(leg.lower.front()).translation_m, ankle, kneeAxis, goal);
    for (const int d : leg.upper) {
      Mat3& r = world_[at(driven_[at(d)].target)].rotation;
      r = turns.upper * r;
    }
    for (const int d : leg.lower) {
      Mat3& r = world_[at(driven_[at(d)].target)].rotation;
      r = turns.lower * r;
    }
  }
  if (!legs_.empty()) placeJoints();
}

void Retargeter::poseFrame(std::size_t frame) {
  poseFigure(source_, frame, sourceWorld_);
  turnDriven();
  placeJoints();
  plantFeet();
}

// Heights of the feet above where they stand in the bind pose, while they stand: of the planted
// joint when it hardly moves from one frame to the next.
std::vector<double> Retargeter::standingHeights() {
  const double slow_m = kStanding_legs_per_s * legLength(targetRest_, true) / 2 /
                        std::max(1.0, source_.motion.rate_hz);
  const std::vector<DrivenLeg> legs = legsOf(driven_);
  std::vector<Vec3> before(legs.size());
  std::vector<double> heights;
  for (std::size_t f = firstFrame_; f < source_.motion.frameCount(); ++f) {
    poseFrame(f);
    for (std::size_t l = 0; l < legs.size(); ++l) {
      const int ball = legs[l].planted;
      const Vec3 now = target(ball).translation_m;
      const double rest = targetRest_[at(driven_[at(ball)].target)].translation_m.y();
      if (f > firstFrame_ && (now - before[l]).norm() < slow_m) heights.push_back(now.y() - rest);
      before[l] = now;
    }
  }
  return heights;
}

void Retargeter::settleStart() {
  if (!options_.startAtRig) return;
  poseFrame(firstFrame_);
  start_m_ +=
      targetRest_[at(driven_[at(root_)].target)].translation_m - target(root_).translation_m;
  std::vector<double> heights = standingHeights();
  if (heights.empty()) return;
  // The median: a foot that rests on something, or rolls over its toes, does not lift the figure.
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  start_m_.y() -= *middle;
}

void Retargeter::append(SampledMotion& out) const {
  const std::size_t count = target_.joints.size();
  for (std::size_t j = 0; j < count; ++j) {
    const int parent = target_.joints[j].parent;
    const Transform local = parent < 0 ? world_[j] : world_[at(parent)].inverse() * world_[j];
    Quat turn(local.rotation);
    turn.normalize();
    if (out.rotation.size() >= count &&
        turn.dot(out.rotation[out.rotation.size() - count].cast<double>()) < 0) {
      turn.coeffs() *= -1;
    }
    out.rotation.push_back(turn.cast<float>());
    out.translation_m.push_back(local.translation_m.cast<float>());
  }
}

}  // namespace

SampledMotion retarget(const MotionFigure& source, const RiggedModel& target, const JointMap& map,
                       const RetargetOptions& options, std::vector<std::string>* notes) {
  return Retargeter(source, target, map, options, notes).run();
}

}  // namespace fascia
