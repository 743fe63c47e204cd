#include <fascia/skin/skin_fit.h>

#include <array>
#include <cmath>
#include <map>
#include <span>

#include <fascia/base/parallel.h>
#include <fascia/measure/deformation.h>

namespace fascia {
namespace {

constexpr double kHalfway = 0.5;  // of the way to the surface: what sticks out less is no fault
constexpr int kTowardsSurface = 8;
// So many of the eight places outside are a fault; one alone is what coarse triangles cut off.
constexpr int kFewOutside = 2;
constexpr std::size_t kMostNamed = 6;

// How often a closed surface winds around a point: 1 inside, 0 outside; where it crosses itself
// also others (van Oosterom & Strackee 1983, "The Solid Angle of a Plane Triangle").
double winding(const TriangleMesh& surface, const Vec3& p) {
  double sum = 0;
  for (const auto& t : surface.triangles) {
    std::array<Vec3, 3> v;
    std::array<double, 3> length;
    for (std::size_t c = 0; c < 3; ++c) {
      v[c] = surface.positions[t[c]].cast<double>() - p;
      length[c] = v[c].norm();
    }
    const double above = v[0].dot(v[1].cross(v[2]));
    const double below = length[0] * length[1] * length[2] + v[0].dot(v[1]) * length[2] +
                         v[1].dot(v[2]) * length[0] + v[2].dot(v[0]) * length[1];
    sum += std::atan2(above, below);
  }
  return sum / (2 * kPi);
}

// The place on a solid's surface that is nearest to p, as far as its estimates lead there.
Vec3 ontoSolid(const DistanceField& flesh, SolidId solid, Vec3 p) {
  for (int n = 0; n < kTowardsSurface; ++n) {
    const auto x = static_cast<float>(p.x()), y = static_cast<float>(p.y()),
               z = static_cast<float>(p.z());
    float d, nx, ny, nz;
    flesh.evaluate(solid, {&x, &y, &z, 1}, &d, {&nx, &ny, &nz, 1});
    p -= double{d} / flesh.lipschitz(solid) * Vec3(nx, ny, nz);
  }
  return p;
}

bool isInside(const MovingField& flesh, SolidId solid, const TriangleMesh& surface) {
  const Transform world = flesh.frame(solid);
  const MovingField::Outline& outline = flesh.outline(solid);
  Vec3 middle = Vec3::Zero();
  for (const Vec3& corner : outline) middle += world.point(corner) / MovingField::kOutline;
  const auto winds = [&](const Vec3& p) { return winding(surface, p) > 0.5; };
  if (!winds(middle)) return false;
  int outside = 0;
  for (const Vec3& corner : outline) {
    const Vec3 onSurface = ontoSolid(flesh, solid, world.point(corner));
    outside += winds(middle + kHalfway * (onSurface - middle)) ? 0 : 1;
  }
  return outside < kFewOutside;
}

std::size_t countCrossings(const TriangleMesh& surface) {
  std::map<std::array<float, 3>, std::uint32_t> known;
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> pointOf;
  for (const Eigen::Vector3f& p : surface.positions) {
    const auto [found, isNew] = known.try_emplace({p.x(), p.y(), p.z()}, points.size());
    if (isNew) points.push_back(p);
    pointOf.push_back(found->second);
  }
  std::vector<std::array<std::uint32_t, 3>> triangles = surface.triangles;
  for (auto& t : triangles)
    for (std::uint32_t& corner : t) corner = pointOf[corner];
  return crossingTrianglePairs(triangles, points);
}

std::string listOfNames(std::span<const SolidId> solids, const Flesh& flesh) {
  std::string names;
  for (std::size_t i = 0; i < std::min(kMostNamed, solids.size()); ++i)
    names += (i == 0 ? "'" : ", '") + flesh.def(solids[i]).name + "'";
  if (solids.size() > kMostNamed)
    names += " and " + std::to_string(solids.size() - kMostNamed) + " more";
  return names;
}

}  // namespace

SkinFit findSkinFit(const MovingField& flesh, const TriangleMesh& surface) {
  std::vector<char> inside(flesh.solidCount());
  parallelFor(inside.size(), [&](std::size_t s) {
    inside[s] = isInside(flesh, SolidId(static_cast<std::int64_t>(s)), surface) ? 1 : 0;
  });
  SkinFit fit;
  for (std::size_t s = 0; s < inside.size(); ++s)
    if (!inside[s]) fit.outside.emplace_back(static_cast<std::int64_t>(s));
  fit.crossings = countCrossings(surface);
  return fit;
}

void warnOfSkinFit(const SkinFit& fit, const Flesh& flesh, bool isTube, const std::string& pointer,
                   Diagnostics& diagnostics) {
  const std::string crossings =
      std::to_string(fit.crossings) + " pairs of its triangles pass through each other at rest";
  const std::string hint =
      isTube ? "let its two ends lie on the flesh, at the ends of the figure; a figure with limbs "
               "or holes wants a skin from its solids' surface: \"surface\": {} in place of "
               "\"grid\", \"bottom\" and \"top\""
             : "make \"edge_m\" smaller than what is left outside, or the solids overlap";
  if (!fit.outside.empty())
    diagnostics.warning(pointer,
                        "leaves " + std::to_string(fit.outside.size()) + " of " +
                            std::to_string(flesh.solidCount()) +
                            " solids outside: " + listOfNames(fit.outside, flesh) +
                            (fit.crossings > 0 ? "; " + crossings : ""),
                        hint);
  else if (fit.crossings > 0)
    diagnostics.warning(pointer, crossings, hint);
}

}  // namespace fascia
