#include <fascia/skin/grid/wrap.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/grid/resample.h>

namespace fascia {
namespace {

// Weights of the discrete Laplacian along and around the tube. The tension along is larger so that
// rows spread evenly from end to end; equal tensions would crowd them at the narrow ends, as a soap
// film does.
constexpr double kAlong = 0.8, kAround = 0.2;
constexpr int kCoarsest = 16;  // rows of the level that starts from the sphere
constexpr int kFirstIterations = 600, kIterations = 120;

Vec3 towardsFront(const Vec3& upAxis) {
  // The front is +z; a tube lying along z has its front on top.
  const Vec3 forward = std::abs(upAxis.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitY();
  return (forward - forward.dot(upAxis) * upAxis).normalized();
}

// Distance to the flesh and its gradient, over all solids, for a row of points.
class FleshDistance {
 public:
  FleshDistance(const Field& field, int columns)
      : field_(field),
        normal_(static_cast<std::size_t>(columns)),
        d_(normal_.size()),
        nearest_(normal_.size()),
        gradient_(normal_.size()) {}

  void measure(ConstVectors row) {
    std::fill(nearest_.begin(), nearest_.end(), 1e30f);
    for (std::size_t s = 0; s < field_.solidCount(); ++s) {
      field_.evaluate(SolidId(std::int64_t(s)), row, d_.data(), view(normal_, 0, row.count));
      for (std::size_t i = 0; i < row.count; ++i) {
        if (d_[i] >= nearest_[i]) continue;
        nearest_[i] = d_[i];
        gradient_.x[i] = normal_.x[i];
        gradient_.y[i] = normal_.y[i];
        gradient_.z[i] = normal_.z[i];
      }
    }
  }
  float distance(std::size_t i) const { return nearest_[i]; }
  const VectorArray& gradient() const { return gradient_; }

 private:
  const Field& field_;
  VectorArray normal_;
  std::vector<float> d_, nearest_;
  VectorArray gradient_;
};

// One Jacobi sweep: each point moves towards its neighbours' mean and, when `cling` > 0, towards
// the flesh; then out of the flesh to the distance of the fat.
void relaxRow(const Field& field, const GridLayout& g, const WrapOptions& options, double cling,
              int j, const VectorArray& from, VectorArray& to) {
  FleshDistance flesh(field, g.columns);
  const auto tension = [&](const FloatArray& a, FloatArray& out) {
    for (int i = 0; i < g.columns; ++i) {
      const std::size_t k = g.at(i, j);
      out[k] = static_cast<float>(0.5 * kAlong * (a[g.at(i, j - 1)] + a[g.at(i, j + 1)]) +
                                  0.5 * kAround * (a[k - 1] + a[k + 1]));
    }
  };
  tension(from.x, to.x), tension(from.y, to.y), tension(from.z, to.z);
  const auto columns = static_cast<std::size_t>(g.columns);
  // Twice: leaving one solid may enter its neighbour.
  for (int pass = 0; pass < 2; ++pass) {
    flesh.measure(view(static_cast<const VectorArray&>(to), g.row(j), columns));
    for (std::size_t i = 0; i < columns; ++i) {
      const double gap = flesh.distance(i) - options.fat_m;
      const double move = gap < 0 ? -gap : pass == 0 ? -cling * gap : 0;
      const std::size_t k = g.row(j) + i;
      to.x[k] += static_cast<float>(move * flesh.gradient().x[i]);
      to.y[k] += static_cast<float>(move * flesh.gradient().y[i]);
      to.z[k] += static_cast<float>(move * flesh.gradient().z[i]);
    }
  }
}

void relax(const Field& field, const GridLayout& g, const WrapOptions& options, double cling,
           int iterations, VectorArray& r) {
  VectorArray next = r;
  for (int n = 0; n < iterations; ++n) {
    parallelFor(static_cast<std::size_t>(g.rows - 2), [&](std::size_t row) {
      relaxRow(field, g, options, cling, static_cast<int>(row) + 1, r, next);
    });
    fillPads(g, next);
    std::swap(r, next);
  }
}

void setEnds(const GridLayout& g, const EndRing& bottom, const EndRing& top, const Vec3& upAxis,
             VectorArray& r) {
  for (int i = 0; i < g.columns; ++i) {
    const double u = static_cast<double>(i) / g.columns;
    setPoint(r, g.at(i, 0), ringPoint(bottom, upAxis, u));
    setPoint(r, g.at(i, g.rows - 1), ringPoint(top, upAxis, u));
  }
  fillPads(g, r);
}

// The share of the gap to the flesh that a point closes per sweep. Tension pulls with the square of
// the points' spacing, so clinging has to weaken alike, or finer skins would follow hollows more.
double clingRate(const GridLayout& g, const WrapOptions& options) {
  constexpr double kReferencePoints = 1024;
  return 0.5 * options.cling *
         std::min(1.0, kReferencePoints / static_cast<double>(g.pointCount()));
}

VectorArray sphereAround(const Field& field, const GridLayout& g, const Vec3& upAxis) {
  Box box;
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    box.add(field.bounds(SolidId(std::int64_t(s))));
  const double radius = 0.55 * box.size().norm();
  const Vec3 front = towardsFront(upAxis), side = upAxis.cross(front);
  VectorArray r(g.storage());
  for (int j = 0; j < g.rows; ++j) {
    const double latitude = kPi * j / (g.rows - 1);
    for (int i = 0; i < g.columns; ++i) {
      const double a = 2 * kPi * i / g.columns;
      const Vec3 around = -std::cos(a) * front - std::sin(a) * side;
      setPoint(r, g.at(i, j),
               box.center() + radius * (std::sin(latitude) * around - std::cos(latitude) * upAxis));
    }
  }
  return r;
}

}  // namespace

Vec3 ringPoint(const EndRing& ring, const Vec3& upAxis, double u) {
  // The ring lies across its own axis, turned as little as possible from the tube's.
  const Vec3 up = ring.axis.dot(upAxis) < 0 ? Vec3(-ring.axis) : ring.axis;
  const Vec3 front = towardsFront(up), side = up.cross(front);
  const double a = 2 * kPi * u;
  return ring.center_m + ring.radius_m * (-std::cos(a) * front - std::sin(a) * side);
}

Vec3 exitPoint(const Field& field, const Vec3& origin, const Vec3& axis, double clearance_m) {
  Box box;
  box.add(origin);
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    box.add(field.bounds(SolidId(std::int64_t(s))));
  const double reach = box.size().norm();
  FleshDistance flesh(field, 1);
  const auto distance = [&](double t) {
    const Vec3 p = origin + t * axis;
    const float x[3] = {static_cast<float>(p.x()), static_cast<float>(p.y()),
                        static_cast<float>(p.z())};
    flesh.measure({&x[0], &x[1], &x[2], 1});
    return double{flesh.distance(0)};
  };
  // March inwards from outside of everything until the clearance is used up, then bisect.
  constexpr int kSamples = 2000;
  double low = 0, high = reach;
  for (int i = kSamples - 1; i > 0; --i) {
    const double t = reach * i / kSamples;
    if (distance(t) < clearance_m) {
      low = t;
      break;
    }
    high = t;
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (distance(middle) < clearance_m ? low : high) = middle;
  }
  return origin + high * axis;
}

VectorArray shrinkWrap(const Field& field, const GridLayout& layout, const EndRing& bottom,
                       const EndRing& top, const WrapOptions& options) {
  Vec3 upAxis = top.center_m - bottom.center_m;
  upAxis = upAxis.norm() > 1e-9 ? Vec3(upAxis.normalized()) : Vec3(Vec3::UnitY());

  std::vector<GridLayout> levels{layout};
  while (levels.back().rows > 2 * kCoarsest && levels.back().columns > 2 * kCoarsest) {
    GridLayout coarser = levels.back();
    coarser.rows = (coarser.rows + 1) / 2;
    coarser.columns = (coarser.columns + 1) / 2;
    levels.push_back(coarser);
  }
  VectorArray r = sphereAround(field, levels.back(), upAxis);
  for (std::size_t n = levels.size(); n-- > 0;) {
    const bool coarsest = n + 1 == levels.size();
    if (!coarsest) r = resample(levels[n + 1], r, levels[n]);
    setEnds(levels[n], bottom, top, upAxis, r);
    // Shrink first, cling then: clinging from afar would pull rows to whatever is nearest.
    if (coarsest) relax(field, levels[n], options, 0, kFirstIterations, r);
    relax(field, levels[n], options, clingRate(levels[n], options), kIterations, r);
  }
  return r;
}

}  // namespace fascia
