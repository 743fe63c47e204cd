#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/point/point_model.h>
#include <fascia/skin/self_contact/self_contact_search.h>

namespace fascia {

// Keeps a skin out of itself. Once per interval: finds points near or behind triangles of other
// parts of the skin that face them, moves both sides apart, lets the flesh have the last word on
// that, and gives the points half spaces for the steps that follow. What crosses in the rest shape
// already is left alone: it never melts, sticks or jitters. See docs/self-contact.md.
class SelfContact {
 public:
  SelfContact() = default;
  explicit SelfContact(const SelfContactModel& model);  // refers to the model

  struct Result {
    std::uint64_t contacts = 0;  // points that were nearer than they may be
    float deepest_m = 0;         // by how much, at most
  };
  // reach_m: how much farther than its velocity says a point may come in the coming interval.
  // Points without any contact keep every bit. fleshNormal: outward from the flesh that a point
  // lies on, or 0; empty: nothing is known. A contact that would push a point off its flesh, or
  // whose triangle looks into its own, is none: skin that is crumpled in a crease has lost its
  // sides, and would work its way out of it.
  Result separate(const PointModel& points, float reach_m, VectorArray& position,
                  VectorArray& velocity, float interval_s = 1.f / 60,
                  const VectorArray& fleshNormal = {});
  // After `separate` and FleshContact::project: half spaces of contacts that are more urgent than
  // the flesh's in `around` replace those.
  void writeHalfSpaces(const VectorArray& position, const VectorArray& velocity, float interval_s,
                       PointSurroundings& around) const;

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
    // Where both sides meet: normal·r = offset, at the interval's start, and its velocity.
    float offset_m;
    Eigen::Vector3f planeVelocity;
    float distance(const VectorArray& position) const;
    float approach(const VectorArray& velocity) const;  // negative: coming nearer
  };
  // What a search goes by.
  struct Inputs {
    const PointModel& points;
    float reach_m;
    const VectorArray &position, &velocity;
    float interval_s;
    const VectorArray& fleshNormal;
  };
  void find(const Inputs& in);
  void findOfPatch(std::size_t patch, const Inputs& in);
  static bool leavesFlesh(const Contact& contact, const VectorArray& fleshNormal);
  void shareOut(const PointModel& points);
  Result limitWays(const VectorArray& position);
  void moveApart(const PointModel& points, VectorArray& position);
  void keepSmooth(VectorArray& position);
  void removeApproach(const PointModel& points, const VectorArray& position, VectorArray& velocity);
  template <class Wanted>
  void balance(const PointModel& points, const Wanted& wanted, VectorArray& values);
  template <class Visit>
  void forEachMoved(const Visit& visit) const;
  Eigen::Vector3f standingOut(const VectorArray& position, std::size_t k) const;
  void placePlane(Contact& c, const VectorArray& position, const VectorArray& velocity) const;
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
  VectorArray start_;  // positions before anything was moved
};

}  // namespace fascia
