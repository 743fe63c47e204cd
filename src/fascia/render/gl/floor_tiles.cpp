#include <fascia/render/gl/floor_tiles.h>

#include <algorithm>
#include <cmath>

namespace fascia::gl {
namespace {

constexpr int kTile = 32;  // pixels; smaller: more to draw one by one, larger: more for nothing

ScreenBox wholeScreen() {
  return {Eigen::Vector2f::Zero(), Eigen::Vector2f::Ones()};
}

int tilesAlong(int pixels) {
  return (pixels + kTile - 1) / kTile;
}

}  // namespace

FloorTiles::FloorTiles(const Eigen::Matrix4f& clipFromWorld, int width, int height,
                       const DarkeningReach& reach)
    : clipFromWorld_(clipFromWorld),
      reach_(reach),
      columns_(tilesAlong(width)),
      rows_(tilesAlong(height)),
      tiles_(Eigen::Vector2f(static_cast<float>(width), static_cast<float>(height)) / kTile),
      marked_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {}

// A square on the floor; all of the picture if the camera is too near to tell.
ScreenBox FloorTiles::aroundFloor(const Eigen::Vector3f& middle_world, float reach_m) const {
  constexpr float kInFront = 1e-6f;
  const Eigen::Vector4f middle = clipFromWorld_ * middle_world.homogeneous();
  const Eigen::Vector4f x = reach_m * clipFromWorld_.col(0), z = reach_m * clipFromWorld_.col(2);
  ScreenBox box;
  for (const float sx : {-1.f, 1.f})
    for (const float sz : {-1.f, 1.f}) {
      const Eigen::Vector4f clip = middle + sx * x + sz * z;
      if (!(clip.z() > -clip.w() && clip.w() > kInFront)) return wholeScreen();
      box.extend(Eigen::Vector2f(0.5f * clip.head<2>() / clip.w() + Eigen::Vector2f(0.5f, 0.5f)));
    }
  return box;
}

FloorTiles::Caster FloorTiles::casterAt(const Eigen::Vector3f& point_world, float floor_m) const {
  Caster caster;
  caster.height_m = point_world.y() - floor_m;
  const float along_m = std::max(caster.height_m, 0.f) / reach_.light.y();
  Eigen::Vector3f foot = point_world - along_m * reach_.light;
  foot.y() = floor_m;
  // The penumbra is stretched where the light is low.
  const float soft_m = (reach_.spread * along_m + reach_.soft_m) / reach_.light.y();
  caster.shadow = aroundFloor(foot, soft_m);
  if (reach_.near_m > 0)
    caster.vicinity = aroundFloor({point_world.x(), floor_m, point_world.z()}, reach_.near_m);
  return caster;
}

void FloorTiles::mark(const ScreenBox& box) {
  const ScreenBox seen = wholeScreen().intersection(box);
  if (seen.isEmpty()) return;
  const auto first = [&](int axis) { return static_cast<int>(seen.min()[axis] * tiles_[axis]); };
  const auto last = [&](int axis, int count) {
    return std::min(static_cast<int>(seen.max()[axis] * tiles_[axis]), count - 1);
  };
  const int right = last(0, columns_), top = last(1, rows_);
  for (int row = first(1); row <= top; ++row) {
    char* const tiles = marked_.data() + static_cast<std::ptrdiff_t>(row) * columns_;
    for (int column = first(0); column <= right; ++column) tiles[column] = 1;
  }
}

void FloorTiles::add(const TriangleMesh& mesh, const Eigen::Matrix4f& worldFromObject,
                     float floor_m) {
  casters_.clear();
  casters_.reserve(mesh.positions.size());
  for (const Eigen::Vector3f& p : mesh.positions)
    casters_.push_back(casterAt((worldFromObject * p.homogeneous()).head<3>(), floor_m));
  for (const auto& [a, b, c] : mesh.triangles) {
    if (std::max({a, b, c}) >= casters_.size()) continue;  // whoever draws it says so
    const Caster &i = casters_[a], &j = casters_[b], &k = casters_[c];
    if (!std::isfinite(i.height_m + j.height_m + k.height_m)) continue;
    mark(i.shadow.merged(j.shadow).merged(k.shadow));
    const bool nears = std::min({i.height_m, j.height_m, k.height_m}) < reach_.near_m &&
                       std::max({i.height_m, j.height_m, k.height_m}) > -reach_.near_m;
    if (nears) mark(i.vicinity.merged(j.vicinity).merged(k.vicinity));
  }
}

std::vector<ScreenBox> FloorTiles::boxes() const {
  struct Run {
    int left, right;
    bool operator==(const Run&) const = default;
  };
  std::vector<ScreenBox> boxes;
  std::vector<std::pair<Run, std::size_t>> above, here;  // with their boxes
  for (int row = 0; row < rows_; ++row) {
    here.clear();
    const char* const tiles = marked_.data() + static_cast<std::ptrdiff_t>(row) * columns_;
    for (int left = 0; left < columns_; ++left) {
      if (!tiles[left]) continue;
      const auto right = static_cast<int>(std::find(tiles + left, tiles + columns_, 0) - tiles);
      const auto corner = [&](int column, int line) {
        return Eigen::Vector2f(static_cast<float>(column) / tiles_.x(),
                               static_cast<float>(line) / tiles_.y());
      };
      const Run run{left, right};
      const auto same =
          std::ranges::find(above, run, [](const auto& earlier) { return earlier.first; });
      std::size_t box = boxes.size();
      if (same != above.end())
        box = same->second;
      else
        boxes.emplace_back(corner(left, row), corner(right, row));
      boxes[box].extend(corner(right, row + 1));
      here.emplace_back(run, box);
      left = right;
    }
    std::swap(above, here);
  }
  for (ScreenBox& box : boxes) box = box.intersection(wholeScreen());
  return boxes;
}

}  // namespace fascia::gl
