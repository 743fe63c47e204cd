#pragma once

#include <vector>

#include <fascia/contact/trace.h>
#include <fascia/deformable/contact/body_contact.h>

namespace fascia {

// Finds the contacts of a step, as planes. A point that moves little is measured at the end of its
// first guess of a way. One that could pass through something is traced along its way (trace.h) and
// meets the plane where it comes near.
class ContactSearch {
 public:
  explicit ContactSearch(const BodyContacts& contacts) : contacts_(contacts) {}

  void resize();  // after surfaces have changed
  void find(const BodyContacts::Step& step, const BodyField& bodies, ContactSet& set);

 private:
  // What a body's points are held against.
  struct Target {
    const MovingField* field;
    SolidId solid;
    Box bounds;  // of its whole way
    double friction, size_m;
    BodyId body;                         // invalid: no body
    const Obstacle* obstacle = nullptr;  // nullptr: no obstacle. Neither: the ground
  };
  struct Plane {
    Nearness at;
    double depth_m = 0;  // that padding has there
    bool deep = false;   // inside of a body that it is tangled with
  };
  struct Found {
    Contact contact;
    std::size_t firstWeight = 0;  // of the touched body's point
  };
  // Of one body; its points are columns.
  struct Work {
    Eigen::Matrix3Xd start, way;
    Box box;  // of the whole ways, with the margin
    std::vector<Found> found;
    std::vector<double> weights;
    std::vector<std::uint32_t> near;  // bodies, or parts of obstacles
    std::vector<int> picked;          // points that may meet the target at hand
    VectorArray place, normal, endNormal, velocity;
    FloatArray distance_m, endDistance_m, depth_m;
  };

  void movePoints(BodyId body);
  void findContacts(BodyId body);
  void meetGround(BodyId body);
  void meet(BodyId body, const Target& target);
  bool pick(Work& work, const Box& bounds) const;
  void addContact(BodyId body, int point, Plane plane, const Vec3& start, const Vec3& way,
                  const Vec3& drift_m, const Target& target);
  Vec3 wayApart(BodyId body, BodyId other) const;
  double marginOf(BodyId body, double otherSize_m) const;
  double stiffnessOf(BodyId body, const Contact& contact, const Target& target) const;
  // What the obstacle's or body's velocity is multiplied with to see the step from its frame.
  double shift_s(const Target& target) const {
    return target.body.valid() ? 0 : step_.h_s + step_.lead_s;
  }

  const BodyContacts& contacts_;
  const BodyField* bodyField_ = nullptr;
  BodyContacts::Step step_{};
  std::vector<Work> work_;
  std::vector<Box> boxes_;  // of bodies
  BroadPhase bodies_;
};

}  // namespace fascia
