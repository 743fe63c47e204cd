#include <fascia/skin/grid/grid_stretch_limit.h>

#include <algorithm>

namespace fascia {
namespace {

using Level = StretchLimit::Level;

// Fewer rows or columns than this are not halved: there is nothing left to pass on.
constexpr std::size_t kFewest = 7;

// Which of a grid's rows or columns a level has; the first is 0.
using Lines = std::vector<int>;

Lines everySecond(const Lines& lines, bool closed) {
  Lines half;
  for (std::size_t i = 0; i < lines.size(); i += 2) half.push_back(lines[i]);
  if (!closed && half.back() != lines.back()) half.push_back(lines.back());
  return half;
}

class Builder {
 public:
  Builder(const ElasticGrid& grid, float maxStretch)
      : grid_(grid), layout_(grid.layout()), maxStretch_(maxStretch) {}

  std::vector<Level> build() const {
    std::vector<Level> levels;
    Lines columns, rows;
    for (int i = 0; i < layout_.columns; ++i) columns.push_back(i);
    for (int j = 0; j < layout_.rows; ++j) rows.push_back(j);
    levels.push_back({edges(columns, rows), {}});
    while (std::min(columns.size(), rows.size()) > kFewest) {
      const Lines fineColumns = std::move(columns), fineRows = std::move(rows);
      columns = everySecond(fineColumns, layout_.closed);
      rows = everySecond(fineRows, false);
      levels.push_back({edges(columns, rows), followers(columns, rows, fineColumns, fineRows)});
    }
    std::ranges::reverse(levels);
    return levels;
  }

 private:
  std::uint32_t at(int i, int j) const {
    return static_cast<std::uint32_t>(layout_.at(layout_.wrapped(i), j));
  }
  // The line after the i-th; of the last column of a tube the first, counted on.
  int next(const Lines& columns, std::size_t i) const {
    return i + 1 < columns.size() ? columns[i + 1] : layout_.columns;
  }

  void addRow(const Lines& columns, int j, std::size_t parity,
              std::vector<StretchLimit::Edge>& out) const {
    const std::size_t count = columns.size() - (layout_.closed ? 0 : 1);
    for (std::size_t i = parity; i < count; i += 2) {
      const int end = next(columns, i);
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
