#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/point_model.h>
#include <fascia/skin/self_contact_search.h>

namespace fascia {

// Keeps a skin out of itself. Once per interval: finds points near or behind triangles of other
// parts of the skin that face them, moves both sides apart, and gives the points half spaces for
// the steps that follow. What crosses in the rest shape already is left alone: it never melts,
// sticks or jitters. See docs/self-contact.md.
class SelfContact {
 public:
  SelfContact() = default;
  explicit SelfContact(const SelfContactModel& model);  // refers to the model

  struct Result {
    std::uint64_t contacts = 0;  // points that were nearer than they may be
    float deepest_m = 0;         // by how much, at most
  };
  // reach_m: how much farther than its velocity says a point may come in the coming interval. Half
  // spaces in `around` that are more urgent than the flesh's replace those; `around` has been
  // written by FleshContact::project before. Points without any contact keep every bit.
  Result resolve(const PointModel& points, float reach_m, VectorArray& position,
                 VectorArray& velocity, PointSurroundings& around, float interval_s = 1.f / 60);

 private:
  // A point and the place on a triangle that it must keep away from.
  struct Contact {
    std::uint32_t point;
    std::array<std::uint32_t, 3> corners;
    Eigen::Vector3f weights;  // of the corners
    Eigen::Vector3f normal;   // of the surface there, towards the point
    float keep_m;             // distance along the normal
    float strength;           // in [0, 1]: fades out where the two sides hardly face each other
    float share;              // of the way apart that the point goes; the other side the rest
    float distance(const VectorArray& position) const;
    float approach(const VectorArray& velocity) const;  // negative: coming nearer
  };
  void find(const PointModel& points, float reach_m, const VectorArray& position,
            const VectorArray& velocity, float interval_s);
  void findOfPatch(std::size_t patch, const PointModel& points, float reach_m,
                   const VectorArray& position, const VectorArray& velocity, float interval_s);
  void shareOut(const PointModel& points, const PointSurroundings& around,
                const VectorArray& position);
  Result limitWays(const VectorArray& position);
  void moveApart(const PointModel& points, const PointSurroundings& around, VectorArray& position);
  void removeApproach(const PointModel& points, const VectorArray& position, VectorArray& velocity);
  template <class Wanted>
  void balance(const PointModel& points, const Wanted& wanted, VectorArray& values);
  void writeHalfSpaces(const VectorArray& position, const VectorArray& velocity, float interval_s,
                       PointSurroundings& around) const;
  void forget();

  const SelfContactModel* model_ = nullptr;
  SurfaceSearch search_;
  std::vector<Contact> found_;              // patches x Patch::kCapacity
  std::vector<std::uint32_t> foundCounts_;  // per patch
  std::vector<Contact> contacts_;           // at most one per point
  std::vector<std::uint32_t> pushed_;       // points without a contact of their own that are pushed
  // Per point; zero outside of resolve.
  std::vector<std::uint8_t> hasContact_;
  FloatArray pushingMass_;  // of the points that push this one
  VectorArray change_;
};

}  // namespace fascia
