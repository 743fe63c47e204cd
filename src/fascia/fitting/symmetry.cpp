#include <fascia/fitting/symmetry.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/geometry/triangle_hierarchy.h>

namespace fascia {
namespace {

constexpr double kJointTolerance = 0.008;    // of the size; more pairs neighbouring fingers
constexpr double kSurfaceTolerance = 0.006;  // of the size
constexpr double kLeastJoints = 0.8, kLeastSurface = 0.92;  // shares that must have an image
constexpr std::size_t kSurfaceProbes = 1500;

const Vec3& position(const RiggedModel& model, std::size_t joint) {
  FASCIA_ASSERT(joint < model.joints.size(), "the joint exists");
  return model.joints[joint].rest_world.translation_m;
}

// The nearest joint to the image of joint `j` that is not taken, hanging on the image of its
// parent.
int imageOf(const RiggedModel& model, const Symmetry& symmetry, std::size_t j, double tolerance_m) {
  const Vec3 image = symmetry.plane.point(position(model, j));
  const int parent = model.joints[j].parent;
  const int wanted = parent < 0 ? -1 : symmetry.partner[static_cast<std::size_t>(parent)];
  int best = -1;
  double least = tolerance_m;
  for (std::size_t k = j + 1; k < model.joints.size(); ++k) {
    if (symmetry.partner[k] >= 0 || (wanted >= 0 && model.joints[k].parent != wanted)) continue;
    const double distance = (position(model, k) - image).norm();
    if (distance >= least) continue;
    least = distance;
    best = static_cast<int>(k);
  }
  return best;
}

// Joints that hold the whole body but move no skin of it: where they stand (often at the world's
// origin, or between the feet) says nothing about the body. They come first, each below the one
// before. Their count.
std::size_t handleCount(const RiggedModel& model) {
  std::vector<std::size_t> children(model.joints.size(), 0);
  std::vector<char> moves(model.joints.size(), 0);
  for (const RigJoint& joint : model.joints)
    if (joint.parent >= 0) ++children[static_cast<std::size_t>(joint.parent)];
  for (const PointWeights& w : model.weights)
    for (std::size_t i = 0; i < PointWeights::kMost && w.weight[i] > 0; ++i) moves[w.joint[i]] = 1;
  std::size_t count = 0;
  while (count < model.joints.size() && !moves[count] &&
         model.joints[count].parent == static_cast<int>(count) - 1) {
    ++count;
    if (children[count - 1] != 1) break;  // what hangs on it are the body's own branches
  }
  return count;
}

Symmetry pairJoints(const RiggedModel& model, const MirrorPlane& plane, double size_m,
                    std::size_t handles) {
  Symmetry symmetry{true, plane, std::vector<int>(model.joints.size(), -1)};
  const double tolerance_m = kJointTolerance * size_m;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    if (symmetry.partner[j] >= 0) continue;
    const int parent = model.joints[j].parent;
    const double off_m = std::abs(position(model, j)[plane.axis] - plane.offset_m);
    const bool onAxis =
        j < handles || (off_m < 0.5 * tolerance_m &&
                        (parent < 0 || symmetry.central(static_cast<std::size_t>(parent))));
    const int image = onAxis ? static_cast<int>(j) : imageOf(model, symmetry, j, tolerance_m);
    if (image < 0) continue;
    symmetry.partner[j] = image;
    symmetry.partner[static_cast<std::size_t>(image)] = static_cast<int>(j);
  }
  return symmetry;
}

double surfaceShare(const RiggedModel& model, const TriangleHierarchy& surface,
                    const MirrorPlane& plane, double tolerance_m) {
  const std::size_t step = std::max<std::size_t>(1, model.points_m.size() / kSurfaceProbes);
  std::size_t probes = 0, met = 0;
  for (std::size_t p = 0; p < model.points_m.size(); p += step) {
    ++probes;
    met += surface.closest(plane.point(model.points_m[p].cast<double>()), tolerance_m).has_value();
  }
  return probes > 0 ? static_cast<double>(met) / static_cast<double>(probes) : 0;
}

}  // namespace

Symmetry findSymmetry(const RiggedModel& model) {
  Box box;
  for (const Eigen::Vector3f& p : model.points_m) box.add(p.cast<double>());
  if (box.empty() || model.joints.empty()) return {};
  const double size_m = box.size().norm();
  const TriangleMesh mesh{model.points_m, {}, {}, model.triangles};
  const TriangleHierarchy surface(mesh);
  const std::size_t handles = handleCount(model);
  const std::size_t body = std::min(handles, model.joints.size() - 1);  // the first joint of it
  for (const int axis : {0, 2}) {
    for (const double offset_m :
         {position(model, 0)[axis], box.center()[axis], position(model, body)[axis]}) {
      const MirrorPlane plane{axis, offset_m};
      Symmetry symmetry = pairJoints(model, plane, size_m, handles);
      const auto met = std::count_if(symmetry.partner.begin(), symmetry.partner.end(),
                                     [](int partner) { return partner >= 0; });
      // Joints that are all in the plane say nothing: a chain is not a pair of limbs.
      if (static_cast<double>(met) < kLeastJoints * static_cast<double>(model.joints.size()))
        continue;
      if (surfaceShare(model, surface, plane, kSurfaceTolerance * size_m) >= kLeastSurface)
        return symmetry;
    }
  }
  return {};
}

}  // namespace fascia
