#pragma once

#include <vector>

#include <fascia/deformable/contact/body_contact.h>

namespace fascia {

// Finds which bodies are inside of what, whatever the steps made of it: measured afresh at given
// coordinates.
class OverlapSearch {
 public:
  explicit OverlapSearch(BodyContacts& contacts) : contacts_(contacts) {}

  void find(std::span<const double> q, double leastShare, std::vector<BodyContacts::Overlap>& out);

 private:
  void placePoints(BodyId body, std::span<const double> q);
  double depth_m(BodyId body, const DistanceField& field, SolidId solid);
  double size_m(BodyId body) const { return contacts_.model_.shape(body).size_m(); }
  void findObstacles(BodyId body, double leastShare);
  void findBodies(BodyId body, double leastShare);

  BodyContacts& contacts_;
  std::vector<BodyContacts::Overlap>* found_ = nullptr;
  std::vector<double> still_;        // velocities of none
  std::vector<VectorArray> points_;  // of each body
  std::vector<Box> boxes_;           // likewise
  BroadPhase bodies_;
  std::vector<std::uint32_t> near_;
  VectorArray inside_, normal_;  // points within a solid's bounds
  FloatArray distance_m_;
};

}  // namespace fascia
