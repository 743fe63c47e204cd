#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include <fascia/fitting/containment.h>
#include <fascia/fitting/muscles.h>

namespace fascia {
namespace {

constexpr int kMostFillers = 3;             // of a part, pairs counted once
constexpr double kLeastShare = 0.08;        // of the part's skin that must be unfilled
constexpr double kLeastBodyShare = 0.0015;  // of the body's
constexpr double kLeastThickness = 0.3;     // half, over the part's radius
constexpr double kOffPlane = 0.3;  // of the part's radius: farther out, fillers come in pairs

double areaOf(const std::vector<SurfaceSample>& samples) {
  double area_m2 = 0;
  for (const SurfaceSample& s : samples) area_m2 += s.area_m2;
  return area_m2;
}

// The worst gap and the unfilled skin around it, on one side of the plane of symmetry if it is.
std::vector<SurfaceSample> worstCluster(const FitSetting& setting, const FleshPart& part,
                                        const std::vector<NamedSolid>& solids, bool& central) {
  const std::vector<double> gap = gaps_m(part, solids);
  std::vector<SurfaceSample> unfilled;
  std::size_t seed = 0;
  double worst = 0;
  for (std::size_t i = 0; i < gap.size(); ++i) {
    if (gap[i] < setting.mostGap_m(part.own[i])) continue;
    if (gap[i] > worst) worst = gap[i], seed = unfilled.size();
    unfilled.push_back(part.own[i]);
  }
  if (unfilled.empty()) return unfilled;
  const MirrorPlane& plane = setting.symmetry.plane;
  const Vec3 at = unfilled[seed].position_m;
  const double off_m = plane.distance_m(at);
  central = part.central && std::abs(off_m) < kOffPlane * part.radius_m;
  std::vector<SurfaceSample> cluster;
  for (const SurfaceSample& s : unfilled) {
    const bool otherSide = part.central && !central && plane.distance_m(s.position_m) * off_m < 0;
    if (!otherSide && (s.position_m - at).norm() < 2.5 * part.radius_m) cluster.push_back(s);
  }
  return cluster;
}

// Along the cluster's longest direction; within the plane of symmetry for a central one.
Vec3 longestDirection(const FitSetting& setting, const std::vector<SurfaceSample>& cluster,
                      bool central) {
  Vec3 mean = Vec3::Zero();
  for (const SurfaceSample& s : cluster) mean += s.area_m2 * s.position_m;
  mean /= areaOf(cluster);
  Mat3 moment = Mat3::Zero();
  for (const SurfaceSample& s : cluster) {
    Vec3 d = s.position_m - mean;
    if (central) d[setting.symmetry.plane.axis] = 0;
    moment += s.area_m2 * d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(moment);
  return solver.eigenvectors().col(2).normalized();
}

// Where it lies from the middle of the part, in words: the character faces +z.
std::string place(const Vec3& from, const Vec3& to) {
  const Vec3 d = to - from;
  int axis = 0;
  d.cwiseAbs().maxCoeff(&axis);
  if (axis == 0) return "side";
  if (axis == 1) return d.y() > 0 ? "top" : "underside";
  return d.z() > 0 ? "front" : "back";
}

std::string freeName(const std::vector<NamedSolid>& solids, std::string name) {
  const std::string first = name;
  for (int n = 2; std::any_of(
           solids.begin(), solids.end(),
           [&](const NamedSolid& s) { return s.suffix == name || s.suffix == name + " left"; });
       ++n)
    name = first + " " + std::to_string(n);
  return name;
}

}  // namespace

std::vector<double> gaps_m(const FleshPart& part, const std::vector<NamedSolid>& solids) {
  std::vector<Vec3> points;
  for (const SurfaceSample& s : part.own) points.push_back(s.position_m);
  std::vector<double> nearest(points.size(), 1e9), d;
  for (const NamedSolid& named : solids) {
    distances(named.solid, points, d);
    for (std::size_t i = 0; i < d.size(); ++i) nearest[i] = std::min(nearest[i], d[i]);
  }
  for (std::size_t i = 0; i < nearest.size(); ++i) nearest[i] -= part.own[i].fat_m;
  return nearest;
}

void addFillers(const FitSetting& setting, const FleshPart& part, const BoneFrame& frame,
                std::vector<NamedSolid>& solids) {
  for (int n = 0; n < kMostFillers; ++n) {
    bool central = false;
    std::vector<SurfaceSample> cluster = worstCluster(setting, part, solids, central);
    const double area_m2 = areaOf(cluster);
    if (cluster.size() < 8 || area_m2 < kLeastShare * areaOf(part.own) ||
        area_m2 < kLeastBodyShare * setting.surface.area_m2())
      return;
    FleshPart whole = part;
    whole.axis = longestDirection(setting, cluster, central);
    const FleshPart sub = subPart(setting.symmetry, frame, whole, std::move(cluster), central);
    const bool pair = part.central && !central;
    FittedSolid solid = wholeGuess(setting.surface, sub, frame);
    const MirrorPlane* plane = pair ? &setting.symmetry.plane : setting.plane(part);
    SolidTarget target = surfaceTarget(setting.surface, sub);
    target.prior = 0.2;
    if (!fitInside(setting.surface, plane, setting.margin_m(), target, solid)) return;
    // Slivers fill nothing and look like growths.
    if (solid.half_m.minCoeff() < kLeastThickness * part.radius_m) return;
    const std::string name = freeName(solids, place(part.middle_m, solid.world.translation_m));
    if (!pair) {
      solids.push_back({name, solid, kFlesh, 0});
      continue;
    }
    const FittedSolid image = solid.mirrored(setting.symmetry.plane);
    const bool left = setting.symmetry.plane.distance_m(solid.world.translation_m) > 0;
    solids.push_back({name + " left", left ? solid : image, kFlesh, 0});
    solids.push_back({name + " right", left ? image : solid, kFlesh, 0});
  }
}

}  // namespace fascia
