#include <fascia/fitting/coverage.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/fitting/containment.h>
#include <fascia/fitting/solid_fitting.h>

namespace fascia {
namespace {

// Flesh counts as beneath if the inward normal meets it before the middle of the body. Looked for
// at a few depths: what a thin solid hides between two of them is not worth a ray caster.
constexpr int kDepths = 5;

struct Probes {
  std::vector<Vec3> points;   // samples.size() * kDepths
  std::vector<char> covered;  // per sample
};

Probes makeProbes(const RestSurface& surface) {
  Probes probes;
  for (const SurfaceSample& s : surface.samples()) {
    const double deepest_m = std::max(s.radius_m, 2 * s.fat_m);
    for (int i = 1; i <= kDepths; ++i)
      probes.points.push_back(s.position_m - deepest_m * i / kDepths * s.normal);
  }
  probes.covered.assign(surface.samples().size(), 0);
  return probes;
}

void markCovered(const FittedSolid& solid, Probes& probes) {
  const double reach_m = solid.solid().bounds().size().norm();
  std::vector<Vec3> near;
  std::vector<std::size_t> owner;
  for (std::size_t i = 0; i < probes.points.size(); ++i) {
    if ((probes.points[i] - solid.world.translation_m).squaredNorm() > reach_m * reach_m) continue;
    near.push_back(probes.points[i]);
    owner.push_back(i / kDepths);
  }
  std::vector<double> d;
  distances(solid, near, d);
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] <= 0) probes.covered[owner[i]] = 1;
  }
}

}  // namespace

void measureFit(const RestSurface& surface, std::span<const FittedSolid> solids,
                std::span<const std::size_t> solidJoint, const WornPieces& worn, FleshFit& fit) {
  FASCIA_ASSERT(worn.size() == fit.joints.size(), "a list for each joint");
  std::vector<double> outside(solids.size());
  parallelFor(solids.size(),
              [&](std::size_t i) { outside[i] = deepestOutside_m(surface, solids[i]); });
  Probes probes = makeProbes(surface);
  for (std::size_t i = 0; i < solids.size(); ++i) {
    JointFit& joint = fit.joints[solidJoint[i]];
    joint.deepest_outside_m = std::max(joint.deepest_outside_m, outside[i]);
    fit.deepest_outside_m = std::max(fit.deepest_outside_m, outside[i]);
    markCovered(solids[i], probes);
  }
  std::vector<double> area_m2(fit.joints.size(), 0), covered_m2(fit.joints.size(), 0);
  for (std::size_t i = 0; i < probes.covered.size(); ++i) {
    const SurfaceSample& s = surface.samples()[i];
    if (std::ranges::find(worn[s.joint[0]], s.piece) != worn[s.joint[0]].end()) continue;
    area_m2[s.joint[0]] += s.area_m2;
    covered_m2[s.joint[0]] += probes.covered[i] ? s.area_m2 : 0;
  }
  double total_m2 = 0, allCovered_m2 = 0, square = 0, fitted_m2 = 0;
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    fit.joints[j].coverage = area_m2[j] > 0 ? covered_m2[j] / area_m2[j] : 0;
    total_m2 += area_m2[j];
    allCovered_m2 += covered_m2[j];
    if (fit.joints[j].solids.empty()) continue;
    square += area_m2[j] * fit.joints[j].residual_rms_m * fit.joints[j].residual_rms_m;
    fitted_m2 += area_m2[j];
  }
  fit.coverage = total_m2 > 0 ? allCovered_m2 / total_m2 : 0;
  fit.residual_rms_m = fitted_m2 > 0 ? std::sqrt(square / fitted_m2) : 0;
}

}  // namespace fascia
