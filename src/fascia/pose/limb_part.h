#pragma once

#include <array>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fascia {

// The implicit body of one bone (Guy & al. style skeleton element, Cani-Gascuel & Desbrun 1997):
// distance to the bone's segment minus a radius that is a smooth function of the place along the
// segment and of the angle around it, with half spheres beyond the ends,
//   f(x) = |x - q| - ρ(t, φ),   q the segment's point nearest to x.
// In the rest posture's space, metres, negative inside. Where the bone has no skin (at its joints)
// the radius is continued harmonically.
class LimbPart {
 public:
  LimbPart() = default;  // no body: exists() is false
  // The part of a segment that the skin points `skin` surround.
  LimbPart(std::span<const Eigen::Vector3f> skin, const Eigen::Vector3f& from,
           const Eigen::Vector3f& to);

  bool exists() const { return meanRadius_m_ > 0; }
  float distance(const Eigen::Vector3f& x) const;
  // And the direction away from the segment, which stands in for the gradient: unit length, no
  // jumps where the map is steep.
  float distance(const Eigen::Vector3f& x, Eigen::Vector3f& away) const;
  // 1 where the bone has skin, 0 where the map is only continued, smooth between.
  float confidence(const Eigen::Vector3f& x) const;
  float distanceFromSegment(const Eigen::Vector3f& x) const;

  const Eigen::Vector3f& begin_m() const { return begin_m_; }
  const Eigen::Vector3f& axis() const { return axis_; }  // unit
  float length_m() const { return length_m_; }
  float meanRadius_m() const { return meanRadius_m_; }
  float greatestRadius_m() const { return greatestRadius_m_; }
  Eigen::Vector3f middle_m() const { return begin_m_ + 0.5f * length_m_ * axis_; }
  // Root mean square of f over points, in mean radii.
  float residual(std::span<const Eigen::Vector3f> skin) const;

 private:
  static constexpr int kCapRows = 4, kBodyRows = 8, kRows = 2 * kCapRows + kBodyRows + 1,
                       kColumns = 16, kCells = kRows * kColumns;
  using Map = std::array<float, kCells>;
  struct Place {
    float row, column, distance;
    Eigen::Vector3f away;
  };
  struct Corners;
  Place locate(const Eigen::Vector3f& x) const;
  static Corners cornersOf(const Place& place);
  static float sample(const Map& map, const Place& place);
  void fitRadius(std::span<const Eigen::Vector3f> skin);
  void continueWhereUnseen(const Map& sum, const Map& count);
  void findSeen(const Map& count);

  Eigen::Vector3f begin_m_ = Eigen::Vector3f::Zero(), axis_ = Eigen::Vector3f::UnitY(),
                  across_ = Eigen::Vector3f::UnitX(), side_ = Eigen::Vector3f::UnitZ();
  float length_m_ = 0, meanRadius_m_ = 0, greatestRadius_m_ = 0;
  Map radius_{}, seen_{};
};

}  // namespace fascia
