#include <fascia/skin/joint_volume.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Points with a smaller bell lie on a region's rim: they move with one side of the joint.
constexpr float kRim = 0.02f;
constexpr std::size_t kLeastPoints = 8;  // fewer enclose nothing that one sees
// The longest way out as a share of the limb's radius: what a pose takes beyond that is a fold of
// the pose, not flesh that has to go somewhere.
constexpr float kLongest = 0.25f;
// Ways out set in over this share of the longest, and near it gently, so that no motion is kicked.
constexpr float kSetIn = 0.03f;
// How quickly the inner side of a bend is left out as the limb folds.
constexpr float kLeaveOut = 2;

Eigen::Vector3f get(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}

Eigen::Matrix3f turnOf(const JointCarrier::Motion& motion) {
  Eigen::Matrix3f turn;
  for (int c = 0; c < 3; ++c) turn.col(c) = motion.column[c].head<3>();
  return turn;
}

// The way out for a wanted one: none inwards, and less than the longest.
float gentle(float wanted_m, float longest_m) {
  const float out_m = std::max(0.f, wanted_m);
  const float set = out_m * out_m / (out_m + kSetIn * longest_m), share = set / longest_m;
  return set / std::sqrt(1 + share * share);
}

// 1 where a point hangs half on either side of a joint.
float bellOf(float share) {
  return 4 * std::max(0.f, share * (1 - share));
}

// Edges that a surface runs through in one direction only, in the direction that closes it.
std::vector<std::array<std::uint32_t, 2>> openEdges(std::span<const JointVolume::Triangle> all) {
  std::map<std::array<std::uint32_t, 2>, int> balance;
  for (const JointVolume::Triangle& t : all)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  std::vector<std::array<std::uint32_t, 2>> open;
  for (const auto& [edge, count] : balance) {
    if (count == 1) open.push_back({edge[1], edge[0]});
    if (count == -1) open.push_back(edge);
  }
  return open;
}

}  // namespace

JointVolume::JointVolume(std::span<const JointCarrier::Joint> joints,
                         std::span<const JointCarrier::Point> points,
                         std::span<const Triangle> triangles, const VectorArray& rest) {
  // Per joint and storage index: how much of a point hangs on the joint or one beyond it.
  std::vector<std::vector<float>> shares(joints.size(), std::vector<float>(rest.size()));
  std::vector<double> ofPoint(joints.size());
  for (const JointCarrier::Point& p : points) {
    subtreeShares(joints, p.weights, ofPoint);
    for (std::size_t j = 0; j < joints.size(); ++j)
      shares[j][p.point] = static_cast<float>(ofPoint[j]);
  }
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (joints[j].parent >= 0)
      addRegion(j, static_cast<std::size_t>(joints[j].parent), shares[j], triangles);

  Scratch scratch;
  scratch.place.resize(localCount_);
  scratch.area.resize(localCount_);
  for (Region& r : regions_) {
    r.volume_m3 = gather(r, rest, scratch);
    float area_m2 = 0;
    for (std::size_t i = 0; i < r.points.size(); ++i) {
      area_m2 += scratch.area[r.first + i].norm();
      r.normal.push_back(scratch.area[r.first + i].normalized());
    }
    // A cylinder's radius is 2 V / A.
    r.longest_m = area_m2 > 0 ? kLongest * 2 * r.volume_m3 / area_m2 : 0;
  }
  // Sheets and what is turned inside out enclose nothing.
  std::erase_if(regions_, [](const Region& r) { return !(r.volume_m3 > 0 && r.longest_m > 0); });
}

void JointVolume::addRegion(std::size_t joint, std::size_t parent, std::span<const float> shares,
                            std::span<const Triangle> triangles) {
  const auto bends = [&](std::uint32_t p) { return bellOf(shares[p]) > kRim; };
  Region region;
  region.joint = joint;
  region.parent = parent;
  for (const Triangle& t : triangles) {
    if (!bends(t[0]) && !bends(t[1]) && !bends(t[2])) continue;
    region.triangles.push_back(t);
    region.points.insert(region.points.end(), t.begin(), t.end());
  }
  std::sort(region.points.begin(), region.points.end());
  region.points.erase(std::unique(region.points.begin(), region.points.end()), region.points.end());
  if (region.points.size() < kLeastPoints) return;
  for (const std::uint32_t p : region.points) {
    region.bell.push_back(bends(p) ? bellOf(shares[p]) : 0.f);
    region.side.push_back(2 * shares[p] - 1);
  }
  for (Triangle& t : region.triangles)
    for (std::uint32_t& corner : t)
      corner = static_cast<std::uint32_t>(
          std::lower_bound(region.points.begin(), region.points.end(), corner) -
          region.points.begin());
  closeRims(region);
  region.first = localCount_;
  localCount_ += region.points.size() + region.rims.size();
  regions_.push_back(std::move(region));
}

// Every connected run of open edges gets a cone over it, whose tip is the run's middle.
void JointVolume::closeRims(Region& region) const {
  const std::vector<std::array<std::uint32_t, 2>> open = openEdges(region.triangles);
  std::vector<std::uint32_t> run(region.points.size());
  for (std::uint32_t i = 0; i < run.size(); ++i) run[i] = i;
  const auto find = [&](std::uint32_t i) {
    while (run[i] != i) i = run[i] = run[run[i]];
    return i;
  };
  for (const auto& e : open) run[find(e[0])] = find(e[1]);
  std::map<std::uint32_t, std::uint32_t> tips;  // by run
  for (const auto& e : open) {
    const auto [tip, isNew] =
        tips.try_emplace(find(e[0]), static_cast<std::uint32_t>(region.rims.size()));
    if (isNew) region.rims.emplace_back();
    region.rims[tip->second].push_back(e[0]);
    region.triangles.push_back(
        {e[0], e[1], static_cast<std::uint32_t>(region.points.size()) + tip->second});
  }
}

// The enclosed volume; writes places and, per point, a third of the area vectors around it.
float JointVolume::gather(const Region& region, const VectorArray& place, Scratch& scratch) {
  const std::span at = std::span(scratch.place).subspan(region.first);
  const std::span area = std::span(scratch.area).subspan(region.first);
  // Near the region, so that single precision keeps what matters.
  const Eigen::Vector3f origin = get(place, region.points.front());
  for (std::size_t i = 0; i < region.points.size(); ++i) {
    at[i] = get(place, region.points[i]) - origin;
    area[i].setZero();
  }
  for (std::size_t r = 0; r < region.rims.size(); ++r) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const std::uint32_t i : region.rims[r]) sum += at[i];
    at[region.points.size() + r] = sum / static_cast<float>(region.rims[r].size());
  }
  float volume_m3 = 0;
  for (const Triangle& t : region.triangles) {
    const Eigen::Vector3f third = (at[t[1]] - at[t[0]]).cross(at[t[2]] - at[t[0]]) / 6;
    volume_m3 += third.dot(at[t[0]]);
    if (t[2] >= region.points.size()) continue;  // a rim's cone is no skin
    for (const std::uint32_t corner : t) area[corner] += third;
  }
  return volume_m3;
}

void JointVolume::moveOut(const Region& region, std::span<const JointCarrier::Motion> motion,
                          float missing_m3, Scratch& scratch) {
  const std::span at = std::span(scratch.place).subspan(region.first);
  const std::span area = std::span(scratch.area).subspan(region.first);
  // The two sides' middles as seen from the joint's own: they point away from each other in a
  // stretched limb, the same way in a folded one.
  Eigen::Vector3f middle[3] = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(),
                               Eigen::Vector3f::Zero()};
  float weight[3] = {0, 0, 0};
  for (std::size_t i = 0; i < region.points.size(); ++i) {
    const float of[3] = {region.bell[i], std::max(0.f, region.side[i]),
                         std::max(0.f, -region.side[i])};
    for (int m = 0; m < 3; ++m) middle[m] += of[m] * at[i], weight[m] += of[m];
  }
  for (int m = 0; m < 3; ++m)
    if (weight[m] > 0) middle[m] /= weight[m];
  const Eigen::Vector3f one = middle[1] - middle[0], other = middle[2] - middle[0];
  const float length = one.norm() + other.norm();
  const Eigen::Vector3f inner =
      length > 0 ? Eigen::Vector3f(kLeaveOut / length * (one + other)) : Eigen::Vector3f::Zero();

  const Eigen::Matrix3f turn = turnOf(motion[region.joint]),
                        parentTurn = turnOf(motion[region.parent]);
  float sum_m2 = 0;
  for (std::size_t i = 0; i < region.points.size(); ++i) {
    const float onJoint = 0.5f * (1 + region.side[i]);
    const Eigen::Vector3f normal =
        onJoint * (turn * region.normal[i]) + (1 - onJoint) * (parentTurn * region.normal[i]);
    const float share = region.bell[i] * std::clamp(1 - normal.dot(inner), 0.f, 1.f);
    sum_m2 += share * area[i].norm();
    area[i] = share * normal;
  }
  const float way_m = gentle(sum_m2 > 0 ? missing_m3 / sum_m2 : 0.f, region.longest_m);
  for (std::size_t i = 0; i < region.points.size(); ++i) area[i] *= way_m;
}

void JointVolume::restore(float share, std::span<const JointCarrier::Motion> motion,
                          Scratch& scratch, VectorArray& place) const {
  scratch.place.resize(localCount_);
  scratch.area.resize(localCount_);
  parallelFor(regions_.size(), [&](std::size_t r) {
    const Region& region = regions_[r];
    const float volume_m3 = gather(region, place, scratch);
    moveOut(region, motion, share * (region.volume_m3 - volume_m3), scratch);
  });
  // A point may lie in several regions.
  for (const Region& region : regions_)
    for (std::size_t i = 0; i < region.points.size(); ++i) {
      const Eigen::Vector3f& way = scratch.area[region.first + i];
      const std::size_t k = region.points[i];
      place.x[k] += way.x(), place.y[k] += way.y(), place.z[k] += way.z();
    }
}

}  // namespace fascia
