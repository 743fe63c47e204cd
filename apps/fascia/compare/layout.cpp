#include "compare/layout.h"

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

constexpr double kText = 0.0165;      // of the picture's mean side
constexpr double kLeastText = 9;      // pixels: smaller cannot be read
constexpr double kLines = 3.7;        // height of the measures, in letters
constexpr double kThin = 0.0018;      // between sides, of the mean side
constexpr double kThick = 0.0055;     // between what is not one pair
constexpr double kRowShare = 0.36;    // of the height, at most, for closer looks below
constexpr double kColumnShare = 0.4;  // of the width, at most, for closer looks beside

struct Gaps {
  int thin, thick;
};

void addMains(const Cell& area, bool wipe, const Gaps& gaps, Layout& layout) {
  if (wipe) {
    layout.mains.push_back(area);
    return;
  }
  const int half = (area.width - gaps.thin) / 2;
  layout.mains.push_back({area.x, area.y, half, area.height});
  layout.mains.push_back(
      {area.x + half + gaps.thin, area.y, area.width - half - gaps.thin, area.height});
}

// Closer looks below the figures.
Layout inARow(Layout layout, const Cell& area, int places, bool wipe, const Gaps& gaps) {
  const int group = (area.width - (places - 1) * gaps.thick) / places;
  const int tile = (group - gaps.thin) / 2;
  const int height = std::min(tile, static_cast<int>(kRowShare * area.height));
  const int y = area.y + area.height - height;
  addMains({area.x, area.y, area.width, area.height - height - gaps.thick}, wipe, gaps, layout);
  for (int i = 0; i < places; ++i) {
    const int x = area.x + i * (group + gaps.thick);
    const int end = i + 1 == places ? area.x + area.width : x + group;
    const int second = x + tile + gaps.thin;
    layout.closer.push_back({Cell{x, y, tile, height}, Cell{second, y, end - second, height}});
  }
  return layout;
}

// Closer looks to the right of the figures: pairs below each other, and a single one as two rows.
Layout inAColumn(Layout layout, const Cell& area, int places, bool wipe, const Gaps& gaps) {
  const bool stacked = places == 1;
  const int rows = stacked ? 2 : places;
  const int height = (area.height - (rows - 1) * (stacked ? gaps.thin : gaps.thick)) / rows;
  const int most = static_cast<int>(kColumnShare * area.width);
  const int tile = stacked ? std::min(height, most) : std::min(height, (most - gaps.thin) / 2);
  const int width = stacked ? tile : 2 * tile + gaps.thin;
  const int x = area.x + area.width - width;
  addMains({area.x, area.y, area.width - width - gaps.thick, area.height}, wipe, gaps, layout);
  if (stacked) {
    const int second = area.y + height + gaps.thin;
    layout.closer.push_back(
        {Cell{x, area.y, tile, height}, Cell{x, second, tile, area.y + area.height - second}});
    return layout;
  }
  for (int i = 0; i < places; ++i) {
    const int y = area.y + i * (height + gaps.thick);
    const int rest = i + 1 == places ? area.y + area.height - y : height;
    layout.closer.push_back({Cell{x, y, tile, rest}, Cell{x + tile + gaps.thin, y, tile, rest}});
  }
  return layout;
}

}  // namespace

Layout arrange(int width, int height, std::size_t places, bool wipe,
               const std::function<double(double aspect)>& distance) {
  const double mean = std::sqrt(static_cast<double>(width) * height);
  const Gaps gaps{std::max(1, static_cast<int>(std::lround(kThin * mean))),
                  std::max(2, static_cast<int>(std::lround(kThick * mean)))};
  Layout blank;
  blank.width = width;
  blank.height = height;
  blank.text = std::max(kLeastText, kText * mean);
  const int lines = static_cast<int>(std::lround(kLines * blank.text));
  blank.figures = {0, height - lines, width, lines};
  const Cell area{0, 0, width, height - lines};
  if (places == 0) {
    addMains(area, wipe, gaps, blank);
    return blank;
  }
  const auto size = [&](const Layout& layout) {
    const Cell& main = layout.mains.front();
    return main.height / distance(main.aspect());
  };
  const int count = static_cast<int>(places);
  Layout row = inARow(blank, area, count, wipe, gaps);
  Layout column = inAColumn(blank, area, count, wipe, gaps);
  return size(column) > size(row) ? column : row;
}

}  // namespace fascia
