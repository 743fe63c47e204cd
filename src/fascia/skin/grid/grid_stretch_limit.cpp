#include <fascia/skin/grid/grid_stretch_limit.h>

#include <algorithm>

#include <fascia/skin/grid/grid_lines.h>

namespace fascia {
namespace {

using Level = StretchLimit::Level;

// No more rows or columns than this are not halved: there is nothing left to pass on.
constexpr std::size_t kFewest = 7;

using Lines = std::vector<int>;

class Builder {
 public:
  Builder(const ElasticGrid& grid, float maxStretch)
      : grid_(grid), layout_(grid.layout()), maxStretch_(maxStretch) {}

  std::vector<Level> build() const {
    const std::vector<GridLines> lines = gridLevels(layout_, kFewest);
    std::vector<Level> levels;
    for (std::size_t l = 0; l < lines.size(); ++l)
      levels.push_back({edges(lines[l].columns, lines[l].rows),
                        l == 0 ? std::vector<StretchLimit::Follower>{}
                               : followers(lines[l].columns, lines[l].rows, lines[l - 1].columns,
                                           lines[l - 1].rows)});
    std::ranges::reverse(levels);
    return levels;
  }

 private:
  std::uint32_t at(int i, int j) const {
    return static_cast<std::uint32_t>(layout_.at(layout_.wrapped(i), j));
  }

  void addRow(const Lines& columns, int j, std::size_t parity,
              std::vector<StretchLimit::Edge>& out) const {
    const std::size_t count = columns.size() - (layout_.closed ? 0 : 1);
    for (std::size_t i = parity; i < count; i += 2) {
      const int end = lineAfter(columns, i, layout_.columns);
      float length_m = 0;
      for (int c = columns[i]; c < end; ++c) length_m += grid_.restLengthU_m(c, j);
      add(at(columns[i], j), at(end, j), length_m, out);
    }
  }
  void addBetween(const Lines& columns, int low, int high,
                  std::vector<StretchLimit::Edge>& out) const {
    for (const int i : columns) {
      float length_m = 0;
      for (int r = low; r < high; ++r) length_m += grid_.restLengthV_m(i, r);
      add(at(i, low), at(i, high), length_m, out);
    }
  }
  void add(std::uint32_t a, std::uint32_t b, float length_m,
           std::vector<StretchLimit::Edge>& out) const {
    if (length_m > 0) out.push_back({a, b, maxStretch_ * length_m});
  }

  // Row by row: to the row before, then within it every second edge and the others.
  std::vector<StretchLimit::Edge> edges(const Lines& columns, const Lines& rows) const {
    std::vector<StretchLimit::Edge> out;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      if (j > 0) addBetween(columns, rows[j - 1], rows[j], out);
      for (const std::size_t parity : {0u, 1u}) addRow(columns, rows[j], parity, out);
    }
    return out;
  }

  // Where a fine line lies between two coarse ones.
  struct Between {
    int low, high;
    float weight;  // of high
  };
  static Between between(const Lines& coarse, int line, int end) {
    const auto above = std::ranges::upper_bound(coarse, line);
    const int low = *(above - 1), high = above == coarse.end() ? end : *above;
    if (line == low) return {low, low, 0};
    return {low, high, static_cast<float>(line - low) / static_cast<float>(high - low)};
  }
  std::vector<StretchLimit::Follower> followers(const Lines& columns, const Lines& rows,
                                                const Lines& fineColumns,
                                                const Lines& fineRows) const {
    std::vector<StretchLimit::Follower> out;
    for (const int j : fineRows) {
      for (const int i : fineColumns) {
        const Between u = between(columns, i, layout_.columns), v = between(rows, j, layout_.rows);
        if (u.low == u.high && v.low == v.high) continue;  // a point of this level
        out.push_back({at(i, j),
                       {at(u.low, v.low), at(u.high, v.low), at(u.low, v.high), at(u.high, v.high)},
                       {(1 - u.weight) * (1 - v.weight), u.weight * (1 - v.weight),
                        (1 - u.weight) * v.weight, u.weight * v.weight}});
      }
    }
    return out;
  }

  const ElasticGrid& grid_;
  const GridLayout& layout_;
  float maxStretch_;
};

}  // namespace

std::vector<Level> gridStretchLimits(const ElasticGrid& grid, float maxStretch) {
  return Builder(grid, maxStretch).build();
}

}  // namespace fascia
