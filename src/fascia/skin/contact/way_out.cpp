#include <fascia/skin/contact/way_out.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fascia/math/points.h>

namespace fascia {
namespace {

// Kept on top of the fat, so that rounding leaves no point inside.
constexpr double kClear_m = 2e-6;
// Steps over solids that are not flat.
constexpr int kTurns = 12;
// Only so many of the deepest planes may bound the way; all must be kept.
constexpr std::size_t kMostPlanes = 8;
constexpr int kMarches = 256;

// What a solid looks like from a point: the way must go by at least `need_m` along `normal`.
struct Plane {
  Vec3 normal;
  double need_m;
};

struct Measure {
  const DistanceField& field;
  std::span<const std::int32_t> solids;
  double distance_m;  // to keep

  // The deepest first.
  void planesAt(const Vec3& p, std::vector<Plane>& out) const {
    out.clear();
    const Eigen::Vector3f x = p.cast<float>();
    for (const std::int32_t s : solids) {
      float d;
      Eigen::Vector3f n;
      field.evaluate(SolidId(s), {&x.x(), &x.y(), &x.z(), 1}, &d, {&n.x(), &n.y(), &n.z(), 1});
      out.push_back({n.cast<double>(), distance_m - double{d}});
    }
    std::ranges::stable_sort(out, std::ranges::greater{}, &Plane::need_m);
  }
};

bool keeps(const std::vector<Plane>& planes, const Vec3& way) {
  return std::ranges::all_of(
      planes, [&](const Plane& p) { return p.normal.dot(way) >= p.need_m - 0.1 * kClear_m; });
}

// The shortest way that just meets `count` planes; none if they are nearly parallel.
template <int count>
std::optional<Vec3> meeting(
    const std::array<const Plane*, static_cast<std::size_t>(count)>& planes) {
  Eigen::Matrix<double, count, 3> normals;
  Eigen::Matrix<double, count, 1> needs;
  for (int i = 0; i < count; ++i) {
    normals.row(i) = planes[static_cast<std::size_t>(i)]->normal.transpose();
    needs[i] = planes[static_cast<std::size_t>(i)]->need_m;
  }
  const Eigen::Matrix<double, count, count> gram = normals * normals.transpose();
  if (std::abs(gram.determinant()) < 1e-6) return std::nullopt;
  return Vec3(normals.transpose() * gram.inverse() * needs);
}

// The shortest way that satisfies every plane; none if there is no such way. The shortest meets
// one, two or three of them.
std::optional<Vec3> shortestWay(const std::vector<Plane>& planes) {
  std::optional<Vec3> best;
  const auto offer = [&](const std::optional<Vec3>& way) {
    if (way && (!best || way->squaredNorm() < best->squaredNorm()) && keeps(planes, *way))
      best = way;
  };
  const std::size_t count = std::min(planes.size(), kMostPlanes);
  for (std::size_t a = 0; a < count; ++a) {
    offer(meeting<1>({&planes[a]}));
    for (std::size_t b = a + 1; b < count; ++b) {
      offer(meeting<2>({&planes[a], &planes[b]}));
      for (std::size_t c = b + 1; c < count; ++c)
        offer(meeting<3>({&planes[a], &planes[b], &planes[c]}));
    }
  }
  return best;
}

// To the faces, edges and corners of a cube.
std::vector<Vec3> directions() {
  std::vector<Vec3> out;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) out.push_back(Vec3(x, y, z).normalized());
  return out;
}

// The shortest of straight ways out: each goes on by the depth that is left until none is.
Vec3 straightOut(const Measure& measure, const Vec3& from) {
  static const std::vector<Vec3> kDirections = directions();
  const std::size_t count = kDirections.size();
  std::vector<double> gone_m(count, 0.0);
  std::vector<char> out(count, 0);
  VectorArray place(count), normal(count);
  FloatArray distance(count), nearest(count);
  for (int march = 0; march < kMarches; ++march) {
    for (std::size_t i = 0; i < count; ++i) setPoint(place, i, from + gone_m[i] * kDirections[i]);
    nearest.assign(count, 3e38f);
    for (const std::int32_t s : measure.solids) {
      measure.field.evaluate(SolidId(s), view(std::as_const(place), 0, count), distance.data(),
                             view(normal, 0, count));
      for (std::size_t i = 0; i < count; ++i) nearest[i] = std::min(nearest[i], distance[i]);
    }
    double shortest = 3e38, least = 3e38;
    for (std::size_t i = 0; i < count; ++i) {
      const double depth = measure.distance_m - double{nearest[i]};
      out[i] = out[i] || depth <= 0;
      if (!out[i]) gone_m[i] += std::max(depth, kClear_m);
      (out[i] ? shortest : least) = std::min(out[i] ? shortest : least, gone_m[i]);
    }
    if (shortest <= least && shortest < 3e38) break;
  }
  std::size_t best = count;
  for (std::size_t i = 0; i < count; ++i)
    if (out[i] && (best == count || gone_m[i] < gone_m[best])) best = i;
  return best == count ? from : Vec3(from + gone_m[best] * kDirections[best]);
}

}  // namespace

Vec3 leaveAll(const DistanceField& field, std::span<const std::int32_t> solids, double fat_m,
              const Vec3& from) {
  const Measure measure{field, solids, fat_m + kClear_m};
  std::vector<Plane> planes;
  Vec3 at = from;
  for (int turn = 0; turn < kTurns; ++turn) {
    measure.planesAt(at, planes);
    if (planes.empty() || planes.front().need_m <= 0.5 * kClear_m) return at;
    const std::optional<Vec3> way = shortestWay(planes);
    if (!way) break;
    at += *way;
  }
  return straightOut(measure, from);
}

}  // namespace fascia
