#pragma once

#include <optional>
#include <vector>

#include <fascia/render/camera.h>

#include "compare/survey.h"

namespace fascia {

// A place on the surface that deserves a closer look, and a way to look at it.
struct Place {
  struct Part {
    std::uint32_t triangle;
    double weight;  // sum 1
  };
  std::vector<Part> parts;
  double radius_m = 0;    // of what is to be seen around it
  Vec3 towards{0, 0, 1};  // from the place to the camera, unit
  // Where it is now: the middle of both sides' triangles.
  Vec3 middle(const RiggedModel& model, const Both<std::vector<Eigen::Vector3f>>& points) const;
};

// At most `most` places where a moment's weights lie thickest, the worst first; apart from each
// other, and none that is hardly worse than its surroundings. `points` are those of the moment.
std::vector<Place> findPlaces(const RiggedModel& model, const Moment& moment,
                              const Both<std::vector<Eigen::Vector3f>>& points, std::size_t most);

// Looks at places from where most of them is seen of both sides, best from about `preferred`.
void chooseViews(const RiggedModel& model, const Both<std::vector<Eigen::Vector3f>>& points,
                 const Vec3& preferred, std::vector<Place>& places);

// From which of these directions most of the places is seen: its number. Earlier ones win ties.
std::size_t chooseView(const RiggedModel& model, const Both<std::vector<Eigen::Vector3f>>& points,
                       std::span<const Place> places, std::span<const Vec3> directions);

}  // namespace fascia
