#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/joint_carrier.h>
#include <fascia/skin/point_model.h>

namespace fascia {

// Where a skin that joints carry folds against itself: on the inner side of elbows, knees, groins,
// knuckles. There two limbs' skin would pass through each other; it meets on a plane instead,
// through the joint, that stands half-way between the two limbs' turns. Whose skin is on which side
// is known from the rest shape, so that nothing has to be searched or remembered.
struct CreaseModel {
  struct Crease {
    std::size_t joint, parent;          // skeleton joints of the two limbs
    Vec3 center_joint, normal_joint;    // in the joint's frame; the normal points into its limb
    Vec3 center_parent, normal_parent;  // the same in the parent's
    double radius_m;                    // how far from the joint both limbs move the skin
    std::uint32_t first, count;         // members
  };
  struct Member {
    std::uint32_t point;  // storage index
    float side;           // 1: the joint's limb, -1: the parent's
    float least_m;        // distance from the plane to keep, on that side; negative at rest already
    float strength;       // in (0, 1]: fades out with the distance from the joint
  };
  std::vector<Crease> creases;
  std::vector<Member> members;
};

// `points` tell of the whole skin; members are those whose storage index is below `elastic`.
CreaseModel prepareCreases(std::span<const JointCarrier::Joint> joints,
                           std::span<const JointCarrier::Point> points, std::size_t elastic);

// Puts every member back on its side: points where joints carry them, which skin is held by. Where
// nothing folds nothing changes, up to rounding.
void meetInCreases(const CreaseModel& model, std::span<const Transform> joints, VectorArray& place);

}  // namespace fascia
