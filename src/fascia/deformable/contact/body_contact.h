#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fascia/contact/obstacles.h>
#include <fascia/deformable/body/body_field.h>
#include <fascia/deformable/contact/contact_points.h>
#include <fascia/deformable/contact/contact_set.h>

namespace fascia {

struct ContactSettings {
  std::optional<double> ground_m{};  // the ground is y = ground_m; without it there is none
  // Coulomb's µ of all that is not given its own; of two surfaces the geometric mean counts.
  double friction = 0.5;  // [0, 10]
  // Surfaces press on each other from this distance on. 0: a hundredth of the body's size, of the
  // smaller one's. A smaller one makes steps take more iterations, a larger one is seen as a gap.
  double margin_m = 0;  // [0, 1e3]
  // What sticks creeps, by less than this part of a body's size per second.
  double creep_per_s = 1e-3;  // (0, 1]
  int points_per_body = 200;  // [1, 1000]; what is smaller than their distance slips between
  bool bodies_collide = true;
};

// What the bodies of a system must not enter: the ground, solids that stand or move by themselves,
// each other. Belongs to a BodySystem (setContacts()); BodyStepper's implicit Euler scheme obeys
// it. Bodies take part that have a surface. Each contact is a LogBarrier and a SlideEnergy with
//     k = max(30 m_eff/h², m g/(4 δ)),   m_eff = 1/(|s_a|² + |s_b|²),
// m the mass of the heaviest body: then what falls with less than 900 δ/h stops outside, and a
// corner carries thirty such k δ, eight times the heaviest body, before it is inside.
class BodyContacts {
 public:
  // Throws Error if a number is out of its range.
  BodyContacts(const BodyModel& model, const Vec3& gravity_m_per_s2,
               const ContactSettings& settings);
  ~BodyContacts();
  BodyContacts(const BodyContacts&) = delete;
  BodyContacts& operator=(const BodyContacts&) = delete;

  const ContactSettings& settings() const { return settings_; }
  // Throw Error if there is no such body or a number is out of its range. No surface: the body
  // takes no part.
  void setSurface(BodyId body, BodySurfacePtr surface, std::optional<double> friction = {});
  void ignorePair(BodyId a, BodyId b);   // these never collide
  void collidePair(BodyId a, BodyId b);  // these do again
  // Solids whose place is that of the end of the next step, and whose velocity took them there.
  // They may be posed anew between steps and must stay where they are in memory until removed.
  ObstacleId addObstacle(const MovingField& field, std::optional<double> friction = {});
  // A surface below which matter gives way as far as `surface` says, as a layer of `modulus_Pa` on
  // something hard: contacts begin at the surface, and harden towards the bottom of the layer.
  ObstacleId addPadding(const SurfaceField& surface, double modulus_Pa,
                        std::optional<double> friction = {});
  void removeObstacle(ObstacleId obstacle) { obstacles_.remove(obstacle); }

  // The contacts of the last step, at its end: for sounds, marks, scripts.
  const ContactSet& contacts() const { return set_; }

  // How deep a point of a body is inside of the ground, an obstacle or another body, measured
  // afresh at the coordinates q: the deepest of each pair that is deeper than a part of the body's
  // size, or of the smaller one's. Bodies in their order.
  struct Overlap {
    BodyId body;
    BodyId other;         // invalid: not a body
    ObstacleId obstacle;  // invalid: not an obstacle. Neither: the ground
    double depth_m;
  };
  void findOverlaps(std::span<const double> q, double leastShare, std::vector<Overlap>& out);

  // For steppers. Pairs that constraints tie to each other do not collide either; `ties` sorted.
  using Pair = std::pair<BodyId, BodyId>;  // first < second
  void setTies(std::vector<Pair> ties) { ties_ = std::move(ties); }
  struct Step {
    std::span<const double> q, v;  // where it begins
    std::span<const double> way;   // a first guess
    double h_s;
    double lead_s;  // from its end to the moment at which the obstacles are posed
  };
  // The contacts that the step may meet. Allocates when surfaces have changed, and when there are
  // more contacts than ever before.
  ContactSet& find(const Step& step);

 private:
  friend class ContactSearch;
  friend class OverlapSearch;
  struct Body {
    BodySurfacePtr surface;
    std::shared_ptr<const ContactPoints> points;
    double friction = 0;
    SolidId solid;  // in field_
  };
  void refresh();
  bool collides(BodyId a, BodyId b) const;

  const BodyModel& model_;
  ContactSettings settings_;
  double gravity_m_per_s2_, heaviest_kg_ = 0;
  std::vector<Body> bodies_;
  Obstacles obstacles_;
  std::vector<Pair> ignored_, ties_;  // sorted
  bool changed_ = true;
  BodyField field_;
  ContactSet set_;
  std::unique_ptr<class ContactSearch> search_;
  std::unique_ptr<class OverlapSearch> overlaps_;
};

}  // namespace fascia
