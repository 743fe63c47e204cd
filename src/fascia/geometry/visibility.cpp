#include <fascia/geometry/visibility.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

constexpr int kSide = 128;  // lines of sight; 1 % of a joint's picture is seen

using ScreenTriangle = std::array<Vec3, 3>;  // x, y on the screen in cells, z towards the viewer

// What is in front on every line of sight.
class Screen {
 public:
  Screen()
      : depth_(static_cast<std::size_t>(kSide) * kSide, -HUGE_VAL), front_(depth_.size(), false) {}

  void draw(const ScreenTriangle& t, bool isChosen) {
    const double twice = turn(t[0], t[1], t[2].x(), t[2].y());
    if (!(std::abs(twice) > 0)) return;
    const auto [left, right] = std::minmax({t[0].x(), t[1].x(), t[2].x()});
    const auto [bottom, top] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
    for (int y = cell(bottom); y <= std::min(top, kSide - 1.0); ++y)
      for (int x = cell(left); x <= std::min(right, kSide - 1.0); ++x)
        visit(t, twice, x, y, isChosen);
  }
  double cellsInFront() const {
    return static_cast<double>(std::count(front_.begin(), front_.end(), true));
  }

 private:
  static int cell(double at) { return std::max(0, static_cast<int>(std::min(at, 1.0 * kSide))); }
  static double turn(const Vec3& a, const Vec3& b, double x, double y) {
    return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
  }

  void visit(const ScreenTriangle& t, double twice, int x, int y, bool isChosen) {
    const double px = x + 0.5, py = y + 0.5;
    const double u = turn(t[1], t[2], px, py) / twice, v = turn(t[2], t[0], px, py) / twice;
    if (u < 0 || v < 0 || u + v > 1) return;
    const double depth = u * t[0].z() + v * t[1].z() + (1 - u - v) * t[2].z();
    const std::size_t at = static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x);
    if (depth <= depth_[at]) return;
    depth_[at] = depth;
    front_[at] = isChosen && twice > 0;
  }

  std::vector<double> depth_;
  std::vector<bool> front_;
};

}  // namespace

double visibleArea(std::span<const std::array<std::uint32_t, 3>> surface,
                   std::span<const Eigen::Vector3f> points, const std::vector<bool>& chosen,
                   const Vec3& towards) {
  FASCIA_ASSERT(chosen.size() == surface.size(), "every triangle is chosen or not");
  FASCIA_ASSERT(isUnit(towards), "one looks along a direction");
  const Vec3 right = towards.unitOrthogonal(), up = towards.cross(right);
  Mat3 view;
  view << right.transpose(), up.transpose(), towards.transpose();
  std::vector<Vec3> seen(points.size());
  for (std::size_t p = 0; p < seen.size(); ++p) seen[p] = view * points[p].cast<double>();
  Box box;
  for (std::size_t t = 0; t < surface.size(); ++t)
    for (const std::uint32_t p : surface[t])
      if (chosen[t] && seen[p].allFinite()) box.add(seen[p]);
  const double cell_m = box.empty() ? 0 : box.size().head<2>().maxCoeff() / kSide;
  if (!(cell_m > 0)) return 0;
  Screen screen;
  for (std::size_t t = 0; t < surface.size(); ++t) {
    ScreenTriangle corners;
    bool finite = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = seen[surface[t][k]];
      finite = finite && p.allFinite();
      corners[k] = {(p.x() - box.low.x()) / cell_m, (p.y() - box.low.y()) / cell_m, p.z()};
    }
    if (finite) screen.draw(corners, chosen[t]);
  }
  return screen.cellsInFront() * cell_m * cell_m;
}

}  // namespace fascia
