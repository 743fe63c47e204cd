#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/skin/contact/contact_kernels.h>
#include <fascia/skin/contact/skin_contact.h>

namespace fascia {

// Some of a skin's points while they are kept out of flesh. Solids are asked in turn, each of all
// groups of points that it may be within reach of: the same result as one group after the other.
class ContactBatch {
 public:
  static constexpr std::size_t kGroups = 64;  // what it holds stays in the second-level cache

  // Groups with all blocks that they are parts of, at most kGroups.
  void load(std::span<const ContactGroup> groups, const VectorArray& position,
            const FloatArray& fat);

  // Moves points out of all solids and finds the nearest ones within `reach_m`. `gaps`: what is
  // known of them, solids.padded() per group; updated. Returns a bound of how far points went.
  float leaveSolids(const DistanceField& field, const CulledSolids& solids, float reach_m,
                    float* gaps);
  // After it: velocities of the matter that points touch, and all that finishContact() writes.
  // Returns the largest squared speed relative to the anchors.
  float finish(const MovingField& field, float reach_m, float restitution, const PointModel& points,
               VectorArray& position, VectorArray& velocity, PointSurroundings& around);

  // How deep the deepest of the points is; moves none. Needs solids' boxes only.
  float deepest(const DistanceField& field, const CulledSolids& solids);

 private:
  static constexpr int kSearches = 4;  // each at least twice as wide as the one before
  static constexpr int kPasses = 16;   // more than creases of three solids need

  template <class T>
  using PerBlock = std::array<T, kGroups>;  // blocks have a group at least

  void leaveInTurn(const DistanceField& field, std::size_t stride, float* gaps);
  bool mustVisitAgain(const DistanceField& field);
  bool searchFarther(const CulledSolids& solids, float reach_m, float* gaps);
  void visit(const DistanceField& field, std::size_t stride, float* gaps);
  void measureDepths(const DistanceField& field);
  void leaveTogether(const DistanceField& field);
  std::span<const std::uint32_t> markedNear(std::size_t solid);
  ConstVectors ask(const DistanceField& field, std::size_t solid,
                   std::span<const std::uint32_t> near);
  void readFleshVelocities(const MovingField& field, float reach_m);

  bool mark(const PerBlock<char>& chosen);  // whether there are any
  std::size_t blockCount() const { return blockOf(groups_.size() - 1) + 1; }
  std::size_t blockOf(std::size_t group) const { return groups_[group].block - groups_[0].block; }
  bool isMarked(std::size_t group) const { return marked_[blockOf(group)] != 0; }

  std::span<const ContactGroup> groups_;
  ContactLanes lanes_;
  std::array<GroupBox, kGroups> boxes_;
  NearGroups near_;

  PerBlock<char> marked_{};  // those that are being visited
  bool allMarked_ = false;
  PerBlock<float> pushed_m_{};               // in all
  PerBlock<float> depth_m_{}, left_m_{};     // in the last visit; after it
  std::array<float, kGroups> searched_m_{};  // per group

  // What a solid was asked, and what it said.
  std::vector<std::uint32_t> some_;
  VectorArray asked_, normal_;
  FloatArray distance_;
  std::array<float, kGroups> smallest_{};
  std::vector<std::int32_t> lane_;
};

}  // namespace fascia
