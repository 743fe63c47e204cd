#include <fascia/fitting/rest_surface.h>

#include <algorithm>
#include <cmath>
#include <span>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/base/random.h>

namespace fascia {
namespace {

constexpr double kWantedSamples = 14000;       // over the whole body; the fits' time grows with it
constexpr std::size_t kMostTriangles = 40000;  // beyond, small ones share samples
constexpr int kMostSplits = 24;                // of a triangle's edge

// Directions without alignment to anything a modeller would align to.
const std::array<Vec3, 5>& voters() {
  static const std::array<Vec3, 5> kDirections = {
      Vec3(0.36, 0.91, 0.21).normalized(), Vec3(-0.83, 0.11, 0.55).normalized(),
      Vec3(0.47, -0.72, -0.51).normalized(), Vec3(0.13, 0.29, -0.95).normalized(),
      Vec3(0.77, 0.19, 0.61).normalized()};
  return kDirections;
}

// The four heaviest joints of a weighted mean of three points' influences.
void mixInfluences(const RiggedModel& model, const std::array<std::uint32_t, 3>& points,
                   const Vec3& share, SurfaceSample& sample) {
  std::array<std::pair<double, std::uint16_t>, 3 * PointWeights::kMost> mixed;
  std::size_t count = 0;
  for (int c = 0; c < 3; ++c) {
    const PointWeights& w = model.weights[points[static_cast<std::size_t>(c)]];
    for (std::size_t i = 0; i < PointWeights::kMost && w.weight[i] > 0; ++i) {
      const double add = share[c] * static_cast<double>(w.weight[i]);
      std::size_t k = 0;
      while (k < count && mixed[k].second != w.joint[i]) ++k;
      if (k == count) mixed[count++] = {0, w.joint[i]};
      mixed[k].first += add;
    }
  }
  std::sort(mixed.begin(), mixed.begin() + static_cast<std::ptrdiff_t>(count),
            [](const auto& a, const auto& b) {
              return a.first != b.first ? a.first > b.first : a.second < b.second;
            });
  for (std::size_t i = 0; i < std::min(count, SurfaceSample::kMostJoints); ++i) {
    sample.joint[i] = mixed[i].second;
    sample.weight[i] = mixed[i].first;
  }
}

TriangleMesh smoothMesh(const RiggedModel& model) {
  TriangleMesh mesh{model.points_m, {}, {}, model.triangles};
  computeNormals(mesh.positions, mesh.triangles, mesh.normals);
  return mesh;
}

}  // namespace

RestSurface::RestSurface(const RiggedModel& model, const FitOptions& options)
    : mesh_(smoothMesh(model)), hierarchy_(mesh_), fatShare_(options.fat_share) {
  height_m_ = std::max(model.height_m(), 0.1 * model.size_m());
  size_m_ = model.size_m();
  leastFat_m_ = options.least_fat * height_m_;
  for (const auto& t : mesh_.triangles) {
    const Vec3 a = mesh_.positions[t[0]].cast<double>(), b = mesh_.positions[t[1]].cast<double>(),
               c = mesh_.positions[t[2]].cast<double>();
    const Vec3 cross = (b - a).cross(c - a);
    area_m2_ += 0.5 * cross.norm();
    faceNormals_.push_back(cross.normalized());
    component_.push_back(model.component.empty() ? 0 : model.component[t[0]]);
  }
  const double spacing_m = std::sqrt(area_m2_ / kWantedSamples);
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) addSamples(model, t, spacing_m);
  thinOutCrowd();
  dropHidden();
  parallelFor(samples_.size(), [&](std::size_t i) { measureThickness(samples_[i]); });
}

double RestSurface::fat_m(double radius_m) const {
  return std::max(leastFat_m_, fatShare_ * radius_m);
}

// Centroids of n² equal pieces. Triangles smaller than a sample's area have one each; if there are
// very many, one in several.
void RestSurface::addSamples(const RiggedModel& model, std::uint32_t triangle, double spacing_m) {
  const auto& corners = mesh_.triangles[triangle];
  std::array<Vec3, 3> p, n;
  for (std::size_t c = 0; c < 3; ++c) {
    p[c] = mesh_.positions[corners[c]].cast<double>();
    n[c] = mesh_.normals[corners[c]].cast<double>();
  }
  const double area_m2 = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
  const auto stride = static_cast<std::uint32_t>(mesh_.triangles.size() / kMostTriangles + 1);
  const bool small = area_m2 < spacing_m * spacing_m;
  if (small && triangle % stride != 0) return;
  const int splits =
      std::clamp(static_cast<int>(std::lround(std::sqrt(area_m2) / spacing_m)), 1, kMostSplits);
  const double piece = 1.0 / splits;
  for (int i = 0; i < splits; ++i) {
    for (int j = 0; j < 2 * (splits - i) - 1; ++j) {
      // Upright pieces at even j, those standing on their heads between them.
      const double third = j % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
      const int row = j / 2;
      const double u = (i + third) * piece, v = (row + third) * piece;
      const Vec3 share(1 - u - v, u, v);
      SurfaceSample sample;
      sample.position_m = share[0] * p[0] + share[1] * p[1] + share[2] * p[2];
      sample.normal = (share[0] * n[0] + share[1] * n[1] + share[2] * n[2]).normalized();
      if (!(sample.normal.squaredNorm() > 0.5)) sample.normal = faceNormals_[triangle];
      sample.area_m2 = area_m2 * piece * piece * (small ? stride : 1);
      sample.piece = component_[triangle];
      mixInfluences(model, corners, share, sample);
      samples_.push_back(sample);
      sampleTriangle_.push_back(triangle);
    }
  }
}

// Every sample sends a dozen rays, and each costs what it may cross. A line through the figure
// meets as many of the triangles' boxes as their area is of the whole box' (Cauchy): one to four in
// figures. Where triangles lie in one another, so do the hierarchy's boxes, and fewer samples must
// do: the square, as rays cost more and tell less.
void RestSurface::thinOutCrowd() {
  constexpr double kUsualMeetings = 20;  // hair in many layers, still
  constexpr std::size_t kLeastSamples = 200;
  const auto area = [](const Box& box) {
    const Vec3 size = box.size();
    return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
  };
  Box whole;
  double sum_m2 = 0;
  for (const auto& t : mesh_.triangles) {
    Box box;
    for (const std::uint32_t corner : t) box.add(mesh_.positions[corner].cast<double>());
    sum_m2 += area(box);
    whole.add(box);
  }
  const double meetings = sum_m2 / std::max(area(whole), 1e-300);
  const double wanted = std::pow(meetings / kUsualMeetings, 2);
  const double most = static_cast<double>(samples_.size()) / static_cast<double>(kLeastSamples);
  const auto stride = static_cast<std::size_t>(std::ceil(std::clamp(wanted, 0.0, most)));
  if (stride < 2) return;
  // Any one out of each row of neighbours: always the first would fall in step with rings of a
  // mesh.
  Random random(1);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples_.size(); i += stride, ++kept) {
    const std::size_t row = std::min(stride, samples_.size() - i);
    const std::size_t chosen = i + random.next() % row;
    samples_[kept] = samples_[chosen];
    samples_[kept].area_m2 *= static_cast<double>(row);
    sampleTriangle_[kept] = sampleTriangle_[chosen];
  }
  samples_.resize(kept);
  sampleTriangle_.resize(kept);
}

// A triangle stays visible if one of its samples is; those without a sample stay, too.
void RestSurface::dropHidden() {
  std::vector<char> hidden(samples_.size(), 0);
  const bool pieces = std::any_of(component_.begin(), component_.end(),
                                  [&](std::uint32_t c) { return c != component_.front(); });
  parallelFor(pieces ? samples_.size() : 0, [&](std::size_t i) {
    // From a little outside, so that doubled surfaces do not hide each other.
    const Vec3 p = samples_[i].position_m + 1e-4 * size_m_ * samples_[i].normal;
    hidden[i] = inside(p, component_[sampleTriangle_[i]]);
  });
  std::vector<char> seen(mesh_.triangles.size(), 0), sampled(mesh_.triangles.size(), 0);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    sampled[sampleTriangle_[i]] = 1;
    if (hidden[i]) {
      hiddenShare_ += samples_[i].area_m2 / area_m2_;
      continue;
    }
    seen[sampleTriangle_[i]] = 1;
    samples_[kept++] = samples_[i];
  }
  samples_.resize(kept);
  sampleTriangle_ = {};
  keepTriangles(sampled, seen);
}

void RestSurface::keepTriangles(const std::vector<char>& sampled, const std::vector<char>& seen) {
  visible_.positions = mesh_.positions;
  visible_.normals = mesh_.normals;
  std::vector<char> used(mesh_.positions.size(), 0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> candidates;  // corner, its piece
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (sampled[t] && !seen[t]) continue;
    visible_.triangles.push_back(mesh_.triangles[t]);
    for (const std::uint32_t corner : mesh_.triangles[t]) {
      if (!used[corner]) candidates.emplace_back(corner, component_[t]);
      used[corner] = 1;
    }
  }
  addCorners(candidates);
  visibleHierarchy_.emplace(visible_);
}

// A large triangle that shows may have a corner that does not: the middle of a hat's brim.
void RestSurface::addCorners(
    const std::vector<std::pair<std::uint32_t, std::uint32_t>>& candidates) {
  std::vector<char> hidden(candidates.size(), 0);
  parallelFor(hiddenShare_ > 0 ? candidates.size() : 0, [&](std::size_t i) {
    const auto& [corner, piece] = candidates[i];
    const Vec3 normal = mesh_.normals[corner].cast<double>();
    hidden[i] = inside(mesh_.positions[corner].cast<double>() + 1e-4 * size_m_ * normal, piece);
  });
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (!hidden[i]) corners_.push_back(mesh_.positions[candidates[i].first].cast<double>());
}

bool RestSurface::inside(const Vec3& p, std::uint32_t except) const {
  constexpr int kMostHits = 64;
  std::vector<TriangleHierarchy::Hit> hits;
  int votes = 0, against = 0;
  for (const Vec3& direction : voters()) {
    if (votes >= 3 || against >= 3) break;  // decided
    hierarchy_.allHits(p, direction, 1e150, hits);
    double from = 0;  // sheets that lie on one another count once
    int surrounding = 0, passed = 0;
    for (const TriangleHierarchy::Hit& hit : hits) {
      if (hit.t < from) continue;
      if (passed++ == kMostHits) break;
      from = hit.t + 1e-7 * size_m_;
      if (component_[hit.triangle] == except) continue;
      surrounding += faceNormals_[hit.triangle].dot(direction) > 0 ? 1 : -1;
    }
    ++(surrounding > 0 ? votes : against);
  }
  return votes >= 3;
}

RestSurface::Nearest RestSurface::nearest(const Vec3& p) const {
  const auto found = visibleHierarchy_->closest(p);
  if (!found) return {p, 1e150};
  const auto& corners = visible_.triangles[found->triangle];
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  for (std::size_t c = 0; c < 3; ++c) {
    normal += static_cast<float>(found->weights[static_cast<int>(c)]) * mesh_.normals[corners[c]];
  }
  const double side = normal.cast<double>().dot(p - found->position);
  return {found->position, side < 0 ? -found->distance_m : found->distance_m};
}

namespace {

// The first crossing of a ray behind its point at `from`: `hits` are all of them from its origin,
// and `next` the first that may be it. Computed from that point, not from the origin: near ones
// differ by less than rounding.
std::optional<TriangleHierarchy::Hit> nextHit(const TriangleHierarchy& hierarchy,
                                              std::span<const TriangleHierarchy::Hit> hits,
                                              std::size_t& next, const Vec3& origin,
                                              const Vec3& direction, double from, double slack) {
  while (next < hits.size() && hits[next].t < from - slack) ++next;
  const Vec3 start = origin + from * direction;
  std::optional<TriangleHierarchy::Hit> best;
  for (std::size_t i = next; i < hits.size(); ++i) {
    if (best && hits[i].t > from + best->t + slack) break;
    const auto hit = hierarchy.hitOf(hits[i].triangle, start, direction);
    if (!hit) continue;
    if (best && (hit->t > best->t || (hit->t == best->t && hit->triangle > best->triangle)))
      continue;
    best = hit;
  }
  return best;
}

}  // namespace

// Pieces that the ray enters on its way must be left again before the body is; if one is open, the
// last way out counts.
double RestSurface::thickness(const Vec3& p, const Vec3& inward, double limit_m) const {
  FASCIA_ASSERT(isUnit(inward, 1e-2) && limit_m >= 0, "one looks inward along a direction");
  constexpr int kMostHits = 12;
  const double slack_m = 1e-9 * size_m_;
  std::vector<TriangleHierarchy::Hit> hits;
  hierarchy_.allHits(p, inward, limit_m + slack_m, hits);
  std::size_t next = 0;
  double t = 1e-5 * size_m_, last = 0;
  int surrounding = 1;
  for (int i = 0; i < kMostHits; ++i) {
    const auto hit = nextHit(hierarchy_, hits, next, p, inward, t, slack_m);
    if (!hit || hit->t > limit_m - t) break;
    t += hit->t;
    const bool leaves = faceNormals_[hit->triangle].dot(inward) > 0;
    surrounding += leaves ? -1 : 1;
    if (leaves) last = t;
    if (surrounding == 0) break;
    t += 1e-6 * size_m_;
  }
  return last;
}

// The shape diameter function (Shapira, Shamir & Cohen-Or 2008): the median length of rays in a
// cone around the inward normal. Ours: a cone of 35° and one ring, for we only want its scale.
void RestSurface::measureThickness(SurfaceSample& sample) const {
  constexpr std::size_t kRing = 6;
  const double cone = radians(35);
  const Vec3 inward = -sample.normal;
  const Vec3 side = inward.unitOrthogonal(), up = inward.cross(side);
  std::array<double, kRing + 1> lengths{};
  lengths[kRing] = thickness(sample.position_m, inward, size_m_);
  for (std::size_t i = 0; i < kRing; ++i) {
    const double turn = 2 * kPi * static_cast<double>(i) / kRing;
    const Vec3 ray =
        std::cos(cone) * inward + std::sin(cone) * (std::cos(turn) * side + std::sin(turn) * up);
    lengths[i] = std::cos(cone) * thickness(sample.position_m, ray, size_m_);
  }
  std::sort(lengths.begin(), lengths.end());
  sample.radius_m = 0.5 * lengths[kRing / 2];
  sample.fat_m = fat_m(sample.radius_m);
}

}  // namespace fascia
