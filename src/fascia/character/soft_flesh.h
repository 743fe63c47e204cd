#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/character/layered_flesh.h>

namespace fascia {

// The soft solids of a character: which bodies they are and where their joints hold them. Constant.
// A body's undeformed points are its solid's own, so that at rest the two are the same.
class SoftFlesh {
 public:
  SoftFlesh() = default;
  // Reports every fault of the soft solids in `def` with pointers below `pointer`; with errors the
  // result must not be used. `flesh` was built from `def`.
  SoftFlesh(const FleshDef& def, const Flesh& flesh, const std::string& pointer,
            Diagnostics& diagnostics);

  struct Part {
    SolidId solid;
    BodyId body;
    JointId joint;
    Transform inJoint;         // the solid's frame
    std::vector<Vec3> held_m;  // in the solid's frame
  };
  bool empty() const { return parts_.empty(); }
  const std::vector<Part>& parts() const { return parts_; }
  const BodyModel& model() const { return model_; }
  bool contains(SolidId solid) const {
    return solid.index() < softOf_.size() && softOf_[solid.index()].valid();
  }

  // Readies `flesh` for update().
  void prepare(LayeredFlesh& flesh) const;
  // All bodies undeformed where the joints are, moving with them.
  void place(const PosedSkeleton& skeleton, OdeState& bodies) const;
  // The velocities alone, of bodies of any shape.
  void setRigidVelocities(const PosedSkeleton& skeleton, OdeState& bodies) const;
  // Moves a body rigidly, velocities with it.
  void carry(const Part& part, const Transform& motion, OdeState& bodies) const;

  // What shows a state again: the shape matrices R of all bodies, one after the other. Unlike the
  // bodies' own coordinates they do not depend on how their mass was summed up.
  std::vector<double> shapes(const OdeState& bodies) const;
  std::size_t shapeSize() const { return model_.size(); }
  // The state at a time, without velocities; `shapes` has shapeSize() numbers.
  void setShapes(std::span<const double> shapes, double time_s, OdeState& bodies) const;

 private:
  void addPart(const SoftSolidDef& soft, const Flesh& flesh, SolidId id);

  std::vector<Part> parts_;
  BodyModel model_;
  BodyField field_;  // at rest
  std::vector<SolidId> softOf_;
};

// Where a joint holds a solid if nobody says otherwise, in the solid's frame: a triangle (or five
// points around a sixth, for bodies that bend) across the end that is nearest to the joint; its
// back, -z, if the joint is in the middle.
std::vector<Vec3> usualHeldPoints(const Solid& solid, const Vec3& joint_solid, bool bends);

}  // namespace fascia
