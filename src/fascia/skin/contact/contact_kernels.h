#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/contact/culled_solids.h>
#include <fascia/skin/point/point_kernels.h>

namespace fascia {

// SIMD kernels that test points against solids, many groups of points in one call: calls of virtual
// functions and of kernels cost as much as a sphere's distances to one group. Dispatched at run
// time.

// Points that lie together, one widest vector of them: what is culled as one.
struct ContactGroup {
  static constexpr std::size_t kLanes = 16;
  std::size_t first;    // storage index
  std::uint32_t count;  // 1 … kLanes
  std::uint32_t block;  // the PointBlock that it is a part of
};

// The box of a group's points with their fat around them.
struct GroupBox {
  float low[3], high[3];
};

// The groups near each solid, by the places of groups in a batch.
class NearGroups {
 public:
  void resize(std::size_t solids, std::size_t groups) {
    groups_ = groups;
    numbers_.resize(solids * groups);
    counts_.resize(solids);
    clear();
  }
  void clear() { counts_.assign(counts_.size(), 0); }
  void add(std::size_t solid, std::uint32_t group) {
    numbers_[solid * groups_ + counts_[solid]++] = group;
  }
  std::size_t solidCount() const { return counts_.size(); }
  std::span<const std::uint32_t> of(std::size_t solid) const {
    return {numbers_.data() + solid * groups_, counts_[solid]};
  }
  template <class Unwanted>
  void drop(const Unwanted& unwanted) {
    for (std::size_t s = 0; s < counts_.size(); ++s) {
      std::uint32_t kept = 0;
      for (const std::uint32_t g : of(s))
        if (!unwanted(g)) numbers_[s * groups_ + kept++] = g;
      counts_[s] = kept;
    }
  }

 private:
  std::size_t groups_ = 0;
  std::vector<std::uint32_t> numbers_;  // groups_ per solid
  std::vector<std::uint32_t> counts_;
};

// A batch's points while they are tested: ContactGroup::kLanes entries per group.
struct ContactLanes {
  VectorArray place;          // r, moved out of solids as they are visited
  VectorArray nearestNormal;  // of the nearest solid so far
  VectorArray pushNormal;     // of the last solid that moved the point; 0 = none
  VectorArray fleshVelocity;  // of the nearest solid's matter
  FloatArray fat;             // distance to keep
  FloatArray nearest;         // gap between fat and nearest solid so far, ≥ 0
  FloatArray pushed;          // way out of solids in this visit
  FloatArray clearance;       // gap to the other solids; 0 if it was inside of two
  FloatArray nearestSolid;    // its number (a float, to blend like the rest)

  void resize(std::size_t groups) {
    const std::size_t n = groups * ContactGroup::kLanes;
    for (VectorArray* a : {&place, &nearestNormal, &pushNormal, &fleshVelocity}) a->resize(n);
    for (FloatArray* a : {&fat, &nearest, &pushed, &clearance, &nearestSolid}) a->resize(n);
  }
};

// Loads a batch's places and fat; writes the boxes of its groups.
void loadGroups(std::span<const ContactGroup> groups, const VectorArray& position,
                const FloatArray& fat, ContactLanes& lanes, GroupBox* boxes);

// Takes from the gap between each group and each solid (solids.padded() per group) how much nearer
// they can have come since the points were at `last`, which is updated: the difference of their
// points' ways at the group's middle, and how much the ways differ over it.
void ageGaps(std::span<const ContactGroup> groups, const VectorArray& position,
             const CulledSolids& solids, VectorArray& last, float* gaps);

// Adds those of a batch's groups that solids are within reach of, by boxes and by `gaps` (nullptr:
// none known). `reach_m` is per group; negative: not to be looked at.
void findNearSolids(std::span<const GroupBox> boxes, const CulledSolids& solids,
                    const float* reach_m, const float* gaps, NearGroups& found);

// Makes groups ready for a visit of all solids near them.
void beginVisit(std::span<const std::uint32_t> groups, ContactLanes& lanes);

// What a solid says of the groups near it.
struct SolidAnswer {
  float solid;  // its number
  std::span<const std::uint32_t> near;
  const float* distance;  // kLanes per group in `near`
  ConstVectors normal;
};

// Takes up the distances and normals to one solid: moves points that are inside out of it, keeps
// the nearest. Groups no point of which is within its reach are left as they are. Writes the
// smallest gap of each group in `near`, negative = inside.
void absorbSolid(const SolidAnswer& answer, std::span<const ContactGroup> groups,
                 const float* reach_m, ContactLanes& lanes, float* smallest);

// Which groups have a point that solids moved by more than `more_m`, and farther than to the next
// one: it may have been pushed into that.
void findPushed(std::span<const ContactGroup> groups, float more_m, const ContactLanes& lanes,
                char* into);

// Packs the places of the points nearest to a solid that finishContact() asks its matter's velocity
// of: those within reach, and those that were moved. Returns how many; `lane` says which. There is
// room for kLanes more than all points of `near`.
std::size_t packNearest(float solid, std::span<const std::uint32_t> near,
                        std::span<const ContactGroup> groups, float reach_m,
                        const ContactLanes& lanes, Vectors place, std::int32_t* lane);

// Writes the result of a batch: moved positions, velocities without their approaching part, half
// spaces. touched[g] = 0: nothing is within reach of a group. Returns the largest squared speed
// relative to the anchors.
float finishContact(std::span<const ContactGroup> groups, const char* touched, float reach_m,
                    float restitution, const PointModel& points, const ContactLanes& lanes,
                    VectorArray& position, VectorArray& velocity, PointSurroundings& around);

}  // namespace fascia
