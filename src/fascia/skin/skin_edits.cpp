#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/skin_parts.h>

namespace fascia {
namespace {

// Beyond so many radii nothing of a brush is left in a float: exp(-r²/2) is below 1e-49.
constexpr double kBrushReach = 15;
// Beyond so many radii less than a hundred-millionth of a millionth of a brush is left: 2⁻²⁵ of
// this share of its amount, half of what a float of that size can hold.
constexpr double kFaintBrush = 8, kLostIn = 1e-6;
// Handed to a thread at once: fewer cost more to hand out than to do.
constexpr std::size_t kPointsPerChunk = 1024;

// 1 inside [low, high], falling to 0 over `feather` outside of it; low > high wraps around.
double inRange(double x, double low, double high, double feather, bool periodic) {
  const auto outsideBy = [&](double t) {
    if (low <= high) return std::max({0.0, low - t, t - high});
    return std::max(0.0, std::min(low - t, t - high));
  };
  double distance = outsideBy(x);
  if (periodic && low <= high) distance = std::min({distance, outsideBy(x - 1), outsideBy(x + 1)});
  if (distance <= 0) return 1;
  if (distance >= feather) return 0;
  const double t = 1 - distance / feather;
  return t * t * (3 - 2 * t);
}

float shareOf(const SkinRegionDef& region, SolidId solid, int joint, const EditPoint& p) {
  FASCIA_ASSERT(joint < 0 || p.weights, "points that are asked by joint have weights");
  if (joint >= 0) {
    float share = 0;
    for (std::size_t k = 0; k < PointWeights::kMost; ++k)
      if (p.weights->joint[k] == joint) share += p.weights->weight[k];
    return share;
  }
  if (!region.solid.empty()) return p.solid == solid ? 1.f : 0.f;
  const double along = inRange(p.v, region.v_min, region.v_max, region.feather, false);
  if (along == 0) return 0;
  return static_cast<float>(inRange(p.u, region.u_min, region.u_max, region.feather, true) * along);
}

int findJointOf(const EditedSkin& skin, const std::string& name) {
  const auto found = std::find(skin.joints.begin(), skin.joints.end(), name);
  return found == skin.joints.end() ? -1 : static_cast<int>(found - skin.joints.begin());
}

// What is wrong with a region that names a joint which no point has a weight for.
void reportRegionJoint(const SkinReport& report, const std::string& where, const EditedSkin& skin,
                       const std::string& name) {
  switch (skin.kind) {
    case SkinKind::grid:
      report.error(where, "a grid has no weights: found a region by joint",
                   "name a solid, or give u and v");
      return;
    case SkinKind::rig:
      report.error(where, "found no joint '" + name + "' in the rig", "'fascia info' lists them");
      return;
    case SkinKind::surface:
      report.findJoint(where, name);
  }
}

double edited(const SkinRegionDef::Edit& edit, double old) {
  switch (edit.mode) {
    case SkinRegionDef::Edit::Mode::set:
      return edit.value;
    case SkinRegionDef::Edit::Mode::scale:
      return old * edit.value;
    case SkinRegionDef::Edit::Mode::add:
      break;
  }
  return old + edit.value;
}

// Points do not depend on each other.
template <class Visit>
void forChunksOf(std::span<const EditPoint> points, const Visit& visit) {
  parallelFor((points.size() + kPointsPerChunk - 1) / kPointsPerChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(points.size(), (chunk + 1) * kPointsPerChunk);
    for (std::size_t i = chunk * kPointsPerChunk; i < end; ++i) visit(i);
  });
}

}  // namespace

std::optional<Vec3> brushCenter(const SkinBrushDef& brush, const SkinBase& base) {
  if (brush.joint.empty()) return brush.center_m;
  const JointId joint = base.skeleton.find(brush.joint);
  if (!joint.valid()) return std::nullopt;
  return base.posedSkeleton.joint_world[joint.index()].point(brush.center_m);
}

void applySkinEdits(const SkinDef& def, const SkinBase& base, const SkinReport& report,
                    std::span<const EditPoint> points, const EditedSkin& skin,
                    const VectorArray& rest, const QuantityMask& changes,
                    SkinQuantities& quantities) {
  const auto isChanged = [&](SkinQuantity q) { return changes[static_cast<std::size_t>(q)]; };
  for (std::size_t n = 0; n < def.regions.size(); ++n) {
    const SkinRegionDef& region = def.regions[n];
    const std::string where = "/regions/" + std::to_string(n);
    int joint = -1;
    if (!region.joint.empty()) {
      joint = findJointOf(skin, region.joint);
      if (joint < 0) {
        reportRegionJoint(report, where + "/joint", skin, region.joint);
        continue;
      }
    } else if (region.solid.empty() && skin.kind != SkinKind::grid) {
      report.error(where, "found a region without a joint or a solid",
                   "only a grid has u and v along and around: name a joint");
      continue;
    }
    if (skin.kind == SkinKind::grid && region.solid.empty() && !(region.v_min <= region.v_max))
      report.error(where + "/v", "found the larger number first",
                   "only u goes around; v runs upwards");
    SolidId solid;
    if (!region.solid.empty()) solid = report.findSolid(where + "/solid", region.solid);
    if (std::ranges::none_of(region.edits, isChanged, &SkinRegionDef::Edit::quantity)) continue;
    std::vector<float> shares(points.size());
    forChunksOf(points,
                [&](std::size_t i) { shares[i] = shareOf(region, solid, joint, points[i]); });
    for (const SkinRegionDef::Edit& edit : region.edits) {
      if (!isChanged(edit.quantity)) continue;
      FloatArray& values = quantities[edit.quantity];
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (shares[i] == 0) continue;
        const double old = values[points[i].point];
        values[points[i].point] = static_cast<float>(old + shares[i] * (edited(edit, old) - old));
      }
    }
  }
  for (std::size_t n = 0; n < def.brushes.size(); ++n) {
    const SkinBrushDef& brush = def.brushes[n];
    const std::string where = "/brushes/" + std::to_string(n);
    const std::optional<Vec3> center = brushCenter(brush, base);
    if (!center) {
      report.findJoint(where + "/joint", brush.joint);  // says what is missing
      continue;
    }
    if (!isChanged(brush.quantity)) continue;
    FloatArray& values = quantities[brush.quantity];
    forChunksOf(points, [&](std::size_t i) {
      const EditPoint& p = points[i];
      const double r = (pointAt(rest, p.point) - *center).norm() / std::max(1e-9, brush.radius_m);
      if (r > kBrushReach) return;
      // What is left of it there is lost in the rounding of what it is added to.
      if (r > kFaintBrush && values[p.point] > kLostIn * std::abs(brush.amount)) return;
      values[p.point] = std::max(
          0.f, values[p.point] + static_cast<float>(brush.amount * std::exp(-0.5 * r * r)));
    });
  }
  for (const QuantityInfo& i : quantityInfos()) {
    if (!isChanged(i.quantity)) continue;
    for (float& v : quantities[i.quantity])
      v = std::clamp(v, static_cast<float>(i.uniform.range.min),
                     static_cast<float>(i.uniform.range.max));
  }
}

}  // namespace fascia
