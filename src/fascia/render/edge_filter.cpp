#include <fascia/render/edge_filter.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <Eigen/Core>

#include <fascia/base/error.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Less contrast is no edge; smaller: shading and textures blur.
constexpr int kLeastContrast = 14;      // grey levels of 255
constexpr int kLeastContrastShare = 8;  // of the brightest neighbour: 1 in …
constexpr int kLongestHalf = 24;        // pixels looked along an edge; shorter: flat stairs stay
constexpr int kOnlyRead = 1;            // pixels around the box that are only read
constexpr std::size_t kRowsPerTask = 32;

// Rows of a picture as they were, and how bright they are.
struct Before {
  int width = 0, top = 0, bottom = 0;  // rows of the picture held here
  std::vector<std::uint8_t> rgba, luma;

  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y - top) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  Eigen::Array3f color(std::size_t place) const {
    const std::uint8_t* const c = rgba.data() + 4 * place;
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  }
};

Before copyRows(const Pixels& picture, int top, int bottom) {
  Before before{picture.width, top, bottom, {}, {}};
  const auto row = static_cast<std::ptrdiff_t>(4) * picture.width;
  before.rgba.assign(picture.rgba.begin() + top * row, picture.rgba.begin() + bottom * row);
  before.luma.resize(before.rgba.size() / 4);
  const std::uint8_t* c = before.rgba.data();
  for (std::uint8_t& luma : before.luma) {
    luma = static_cast<std::uint8_t>((2 * c[0] + 5 * c[1] + c[2]) / 8);
    c += 4;
  }
  return before;
}

// Which pixels of a row differ enough from a neighbour.
void markEdges(const Before& before, int y, const PixelBox& box, std::vector<std::uint8_t>& marks) {
  const std::uint8_t* const luma = before.luma.data() + before.place(0, y);
  const std::ptrdiff_t row = before.width;
  for (int x = box.left; x < box.right; ++x) {
    const std::uint8_t *const here = luma + x, north = *(here - row), south = *(here + row);
    const std::uint8_t high = std::max({*here, north, south, *(here - 1), *(here + 1)});
    const std::uint8_t low = std::min({*here, north, south, *(here - 1), *(here + 1)});
    marks[static_cast<std::size_t>(x)] =
        high - low > std::max(kLeastContrast, high / kLeastContrastShare) ? 1 : 0;
  }
}

// Lottes, "FXAA" (2009), without its blur of single pixels: finds the ends of the step that the
// edge through a pixel makes here, and how much of the pixel is on the other side.
class EdgeWalk {
 public:
  EdgeWalk(const Before& before, const PixelBox& box, int x, int y)
      : before_(before), box_(box), x_(x), y_(y), here_(at(0, 0)) {
    const int n = at(0, -1), s = at(0, 1), w = at(-1, 0), e = at(1, 0);
    const int nw = at(-1, -1), ne = at(1, -1), sw = at(-1, 1), se = at(1, 1);
    const int bendDown =
        2 * std::abs(n + s - 2 * here_) + std::abs(ne + se - 2 * e) + std::abs(nw + sw - 2 * w);
    const int bendAlong =
        2 * std::abs(w + e - 2 * here_) + std::abs(nw + ne - 2 * n) + std::abs(sw + se - 2 * s);
    level_ = bendDown >= bendAlong;
    const int first = level_ ? n : w, second = level_ ? s : e;
    side_ = std::abs(first - here_) >= std::abs(second - here_) ? -1 : 1;
    const int across = side_ < 0 ? first : second;
    step_ = std::abs(across - here_);
    sum_ = here_ + across;
  }

  // Of the pixel, [0, 0.5): what the place across the edge covers.
  float share() const {
    int backDelta = 0, forthDelta = 0;
    const float back = length(-1, backDelta), forth = length(1, forthDelta);
    // The stairs lead away from here: the neighbour across the edge takes its share instead.
    const int delta = back < forth ? backDelta : forthDelta;
    if (delta == 0 || (delta < 0) == (2 * here_ - sum_ < 0)) return 0;
    return 0.5f - std::min(back, forth) / (back + forth);
  }

  std::size_t across() const {
    return level_ ? before_.place(x_, y_ + side_) : before_.place(x_ + side_, y_);
  }

 private:
  int at(int dx, int dy) const { return before_.luma[before_.place(x_ + dx, y_ + dy)]; }
  // Sum over both sides of the edge, `along` pixels from here.
  int pairAt(int along) const {
    return level_ ? at(along, 0) + at(along, side_) : at(0, along) + at(side_, along);
  }
  // Pixels to where the edge ends; delta: how much brighter the pair there is, twofold.
  float length(int direction, int& delta) const {
    const int room = level_ ? (direction < 0 ? x_ - box_.left : box_.right - 1 - x_)
                            : (direction < 0 ? y_ - box_.top : box_.bottom - 1 - y_);
    const int last = std::min(kLongestHalf, room);
    for (int i = 1; i <= last; ++i) {
      delta = pairAt(direction * i) - sum_;
      if (2 * std::abs(delta) >= step_) return static_cast<float>(i) - 0.5f;
    }
    delta = 0;  // no end in sight
    return static_cast<float>(last) + 0.5f;
  }

  const Before& before_;
  const PixelBox& box_;
  int x_, y_, here_;
  bool level_ = false;  // the edge runs along the row
  int side_ = 1;        // where its other side is
  int step_ = 0, sum_ = 0;
};

// Brighter or darker than all around it. Where surfaces meet, the one sample of a pixel may hit
// what is behind; more would make that faint. It flickers when it moves.
bool isSpeck(const Before& before, int x, int y) {
  const int here = before.luma[before.place(x, y)];
  int brighter = 0, darker = 0;
  for (const int dy : {-1, 0, 1})
    for (const int dx : {-1, 0, 1}) {
      const int off = before.luma[before.place(x + dx, y + dy)] - here;
      brighter += off > kLeastContrast ? 1 : 0, darker += off < -kLeastContrast ? 1 : 0;
    }
  return brighter == 8 || darker == 8;
}

Eigen::Array3f smoothedColor(const Before& before, const PixelBox& box, int x, int y) {
  const Eigen::Array3f here = before.color(before.place(x, y));
  if (isSpeck(before, x, y))
    return 0.25f * (before.color(before.place(x - 1, y)) + before.color(before.place(x + 1, y)) +
                    before.color(before.place(x, y - 1)) + before.color(before.place(x, y + 1)));
  const EdgeWalk walk(before, box, x, y);
  const float share = walk.share();
  return share > 0 ? here + share * (before.color(walk.across()) - here) : here;
}

void smoothRow(const Before& before, int y, const PixelBox& box, std::vector<std::uint8_t>& marks,
               Pixels& picture) {
  markEdges(before, y, box, marks);
  const auto rowStart = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width);
  for (int x = box.left; x < box.right; ++x) {
    if (!marks[static_cast<std::size_t>(x)]) continue;
    const Eigen::Array3f color = smoothedColor(before, box, x, y);
    std::uint8_t* const out = picture.rgba.data() + 4 * (rowStart + static_cast<std::size_t>(x));
    for (int k = 0; k < 3; ++k) out[k] = static_cast<std::uint8_t>(std::lround(color[k]));
  }
}

}  // namespace

void smoothEdges(Pixels& picture, const PixelBox& wanted) {
  if (picture.width < 0 || picture.height < 0 ||
      picture.rgba.size() !=
          4 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height))
    throw Error("render: a picture has not as many bytes as its size says");
  const PixelBox box{std::max(wanted.left, kOnlyRead), std::max(wanted.top, kOnlyRead),
                     std::min(wanted.right, picture.width - kOnlyRead),
                     std::min(wanted.bottom, picture.height - kOnlyRead)};
  if (box.left >= box.right || box.top >= box.bottom) return;
  const Before before = copyRows(picture, box.top - kOnlyRead, box.bottom + kOnlyRead);
  const auto rows = static_cast<std::size_t>(box.bottom - box.top);
  parallelFor((rows + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    std::vector<std::uint8_t> marks(static_cast<std::size_t>(picture.width));
    const std::size_t end = std::min(rows, (task + 1) * kRowsPerTask);
    for (std::size_t i = task * kRowsPerTask; i < end; ++i)
      smoothRow(before, box.top + static_cast<int>(i), box, marks, picture);
  });
}

}  // namespace fascia
