#include <fascia/io/rig_model/simulated_surface.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <unordered_set>

#include <fascia/base/error.h>
#include <fascia/geometry/orientation.h>
#include <fascia/geometry/weld.h>

namespace fascia {
namespace {

// Half the sum of differences is the share of the weight that another joint has.
bool movedAlike(const PointWeights& a, const PointWeights& b) {
  constexpr float kMostDifference = 0.1f;
  float difference = 0;
  for (std::size_t i = 0; i < PointWeights::kMost; ++i) {
    float other = 0;
    for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
      if (b.weight[k] > 0 && b.joint[k] == a.joint[i]) other += b.weight[k];
    }
    if (a.weight[i] > 0) difference += std::max(0.f, a.weight[i] - other);
  }
  return difference <= kMostDifference;  // both sum to one: what one lacks the other has too much
}

struct TriangleHash {
  std::size_t operator()(const std::array<std::uint32_t, 3>& t) const {
    return (std::size_t{t[0]} * 73856093) ^ (std::size_t{t[1]} * 19349663) ^
           (std::size_t{t[2]} * 83492791);
  }
};

void keepSoundTriangles(RiggedModel& model) {
  std::unordered_set<std::array<std::uint32_t, 3>, TriangleHash> seen;
  std::size_t flat = 0, doubled = 0;
  for (const auto& drawn : model.drawnTriangles) {
    std::array<std::uint32_t, 3> t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = model.vertices[drawn[k]].point;
    if (isDegenerate(model.points_m[t[0]], model.points_m[t[1]], model.points_m[t[2]])) {
      ++flat;
      continue;
    }
    std::array<std::uint32_t, 3> sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (!seen.insert(sorted).second) {
      ++doubled;
      continue;
    }
    model.triangles.push_back(t);
  }
  if (flat > 0) {
    model.notes.push_back(std::to_string(flat) + " triangles have no area: drawn, not simulated");
  }
  if (doubled > 0) {
    model.notes.push_back(std::to_string(doubled) +
                          " triangles lie on others of the same points: drawn, not simulated");
  }
}

// Only what is simulated is turned: the file shows its triangles as it always did.
void turnInsideOutPieces(RiggedModel& model) {
  const TriangleMesh mesh{model.points_m, {}, {}, model.triangles};
  const std::vector<std::uint32_t> pieces =
      insideOutPieces(mesh, model.component, model.componentCount);
  if (pieces.empty()) return;
  for (auto& t : model.triangles)
    if (std::ranges::binary_search(pieces, model.component[t[0]])) std::swap(t[1], t[2]);
  model.notes.push_back(std::to_string(pieces.size()) + " of " +
                        std::to_string(model.componentCount) +
                        " pieces of the mesh are inside out: turned");
}

std::string threeDigits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

void buildSimulatedSurface(std::span<const Eigen::Vector3f> positions_m,
                           std::span<const PointWeights> weights, RiggedModel& model,
                           const std::function<bool(std::uint32_t, std::uint32_t)>& alike) {
  Box box;
  for (const Eigen::Vector3f& p : positions_m) box.add(p.cast<double>());
  const double size = box.empty() ? 0 : box.size().norm();
  const Weld weld = weldVertices(
      positions_m, model.drawnTriangles, static_cast<float>(1e-6 * size), [&](auto a, auto b) {
        return movedAlike(weights[a], weights[b]) && (!alike || alike(a, b));
      });
  model.points_m.resize(weld.pointCount);
  model.weights.resize(weld.pointCount);
  for (std::size_t v = positions_m.size(); v-- > 0;) {  // a point is its first vertex
    model.vertices[v].point = weld.point[v];
    model.points_m[weld.point[v]] = positions_m[v];
    model.weights[weld.point[v]] = weights[v];
  }
  keepSoundTriangles(model);
  if (model.triangles.empty()) {
    Issue issue;
    issue.where.file = model.sourceFile;
    issue.message = "has no triangle with an area: there is no surface to simulate";
    throw Error(std::move(issue));
  }
  model.componentCount = numberComponents(model.points_m.size(), model.triangles, model.component);
  turnInsideOutPieces(model);
}

void noteOddSize(double scale, RiggedModel& model) {
  constexpr double kSmallest_m = 0.05, kLargest_m = 20;
  Box box;
  for (const Eigen::Vector3f& p : model.points_m) box.add(p.cast<double>());
  const Vec3 size = box.size();
  const double height = model.height_m(), longest = size.maxCoeff();
  if (longest > kLargest_m || longest < kSmallest_m) {
    const bool large = longest > kLargest_m, milli = longest > 500;
    std::string note = "this character is " + threeDigits(height) + " m tall and " +
                       threeDigits(longest) + " m long; if ";
    note += !large  ? "it should be larger"
            : milli ? "its file is in millimetres"
                    : "its file is in centimetres";
    const double factor = !large ? 100 : milli ? 0.001 : 0.01;
    model.notes.push_back(note + " give --scale " + threeDigits(factor * scale));
  }
  // A person on the back: long along z, flat along y, wide along x. Animals are no flatter than a
  // third of their length and stand on their feet, at y = 0.
  const bool lies = size.y() < 0.25 * size.z() && size.x() > 0.2 * size.z() &&
                    std::abs(box.low.z()) < 0.05 * size.z();
  if (lies) {
    model.notes.emplace_back(
        "this character seems to lie on its back: if it should stand, its file was written with z "
        "up; export it with y up, as glTF wants it");
  }
}

bool packWeights(std::vector<std::pair<std::uint16_t, float>>& influences, PointWeights& out) {
  for (auto& influence : influences) {
    if (!(influence.second > 0) || !std::isfinite(influence.second)) influence.second = 0;
  }
  std::sort(influences.begin(), influences.end());
  std::size_t count = 0;  // one per joint
  for (std::size_t i = 0; i < influences.size(); ++i) {
    if (count > 0 && influences[count - 1].first == influences[i].first) {
      influences[count - 1].second += influences[i].second;
    } else {
      influences[count++] = influences[i];
    }
  }
  influences.resize(count);
  std::stable_sort(influences.begin(), influences.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  influences.resize(std::min(count, PointWeights::kMost));
  double sum = 0;
  for (const auto& influence : influences) sum += influence.second;
  out = {};
  if (!(sum > 1e-6)) return false;
  for (std::size_t i = 0; i < influences.size() && influences[i].second > 0; ++i) {
    out.joint[i] = influences[i].first;
    out.weight[i] = static_cast<float>(influences[i].second / sum);
  }
  return true;
}

void makeNamesUnique(RiggedModel& model) {
  std::set<std::string> taken, used;
  std::map<std::string, int> counters;
  for (const RigJoint& joint : model.joints) taken.insert(joint.name);
  std::size_t unnamed = 0, doubled = 0;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    std::string& name = model.joints[j].name;
    const bool none = name.empty();
    if (!none && used.insert(name).second) continue;
    ++(none ? unnamed : doubled);
    const std::string stem = none ? "joint " + std::to_string(j) : name;
    std::string fresh = stem;
    int& counter = counters[stem];
    while (!taken.insert(fresh).second) fresh = stem + " (" + std::to_string(++counter + 1) + ")";
    used.insert(fresh);
    name = std::move(fresh);
  }
  if (unnamed > 0) model.notes.push_back(std::to_string(unnamed) + " joints had no name: numbered");
  if (doubled > 0) {
    model.notes.push_back(std::to_string(doubled) + " joints had another joint's name: numbered");
  }
}

}  // namespace fascia
