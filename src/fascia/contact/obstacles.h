#pragma once

#include <span>
#include <vector>

#include <fascia/contact/broad_phase.h>
#include <fascia/field/surface_field.h>

namespace fascia {

using ObstacleId = Id<struct ObstacleTag>;

// Something that nothing may enter and that moves by itself.
struct Obstacle {
  ObstacleId id;
  const MovingField* field;
  double friction;                        // µ
  const SurfaceField* padding = nullptr;  // `field`, if it gives way
  double modulus_Pa = 0;                  // of the padding
};

// All obstacles of a scene, and the solids that they are made of. Fields may be posed anew between
// updates and must stay where they are in memory until removed.
class Obstacles {
 public:
  ObstacleId add(const MovingField& field, double friction);
  ObstacleId addPadding(const SurfaceField& surface, double modulus_Pa, double friction);
  void remove(ObstacleId obstacle);

  // Where the solids are, and may have been up to span_s ago. Allocates only when there are more
  // than ever before.
  void update(double span_s);

  struct Part {
    const Obstacle* obstacle;
    SolidId solid;
    Box bounds;  // over the span
  };
  // As of the last update(): obstacles in the order they were added, each one's solids in theirs.
  std::span<const Part> parts() const { return parts_; }
  // Numbers of parts, ascending. Any number of threads, each with its own list.
  void find(const Box& box, std::vector<std::uint32_t>& found) const { near_.find(box, found); }

 private:
  std::vector<Obstacle> obstacles_;
  int next_ = 0;
  std::vector<Part> parts_;
  std::vector<Box> boxes_;
  BroadPhase near_;
};

// The speed of the fastest corner of a solid's outline, m/s.
double outlineSpeed(const MovingField& field, SolidId solid);

}  // namespace fascia
