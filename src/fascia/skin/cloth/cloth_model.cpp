#include <fascia/skin/cloth/cloth_model.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

// Levels end with one that has no more rows or columns: a sweep crosses it.
constexpr std::size_t kCoarsestSide = 16;
// Shear acts on the finest level with no more rows or columns, but not on the grid itself. Finer:
// a sheet of 100 000 points stretched to 18 % where it lay over a ball.
constexpr std::size_t kShearSide = 50;
// An edge's stretch is taken back by about so many corrections: those of all levels, there and
// back. Found by the stretch of hanging sheets, see docs/solvers.md.
constexpr double kCorrections = 7;

using Limit = ClothLevel::Limit;

// Limits between points of so many 1/kg. `compliance` is m/N over h²: what the limit
// gives way per excess. Each of several corrections takes less than the one that would do it alone.
class ShareRule {
 public:
  Limit operator()(double first, double second, double compliance, double length_m) {
    if (first + second == 0 || length_m == 0) return {};
    const double mean = first > 0 && second > 0 ? 0.5 * (first + second) : first + second;
    const double q = compliance / mean;
    if (q != asked_) {
      asked_ = q;
      const double left = std::pow(q / (2 + q), 1 / kCorrections);
      slack_ = 2 * left / (1 - left);
    }
    return divided(first, second, slack_ * mean, length_m);
  }
  // One that takes all at once.
  static Limit alone(double first, double second, double compliance, double length_m) {
    if (first + second == 0) return {};
    return divided(first, second, compliance, length_m);
  }

 private:
  static Limit divided(double first, double second, double slack, double length_m) {
    const double whole = first + second + slack;
    return {static_cast<float>(first / whole), static_cast<float>(second / whole),
            static_cast<float>(length_m)};
  }

  double asked_ = -1, slack_ = 0;  // most sheets ask the same all the time
};

// Writes three lists of `half` floats one after the other, an edge at a time.
class LimitLists {
 public:
  LimitLists(FloatArray& out, std::size_t half) : out_(out), half_(half) {}
  void set(std::size_t list, std::size_t k, const Limit& limit) {
    out_[3 * list * half_ + k] = limit.first;
    out_[(3 * list + 1) * half_ + k] = limit.second;
    out_[(3 * list + 2) * half_ + k] = limit.length_m;
  }

 private:
  FloatArray& out_;
  std::size_t half_;
};

// Where `list` is in the tables: the row before's, if it has the same.
std::size_t stored(const FloatArray& list, std::size_t before, bool hasBefore, FloatArray& tables) {
  if (hasBefore && std::equal(list.begin(), list.end(), tables.begin() + static_cast<long>(before)))
    return before;
  const std::size_t at = tables.size();
  tables.insert(tables.end(), list.begin(), list.end());
  return at;
}

}  // namespace

ClothModel::ClothModel(const ElasticGrid& elastic, const VectorArray& rest,
                       const PointModel& points)
    : layout_(elastic.layout()) {
  FASCIA_ASSERT(rest.size() == layout_.storage() && points.mass.size() == layout_.storage(),
                "a place and a mass for each point");
  for (GridLines& lines : gridLevels(layout_, kCoarsestSide))
    levels_.emplace_back().lines = std::move(lines);
  shearLevel_ = std::min(std::max<std::size_t>(1, levelFor(kShearSide)), levels_.size() - 1);
  double strips = 1;
  for (Level& level : levels_) {
    addPoints(points, 1 / (strips * strips), level);
    addEdges(elastic, strips, level);
    strips *= 2;
  }
  addCells(elastic, rest, levels_[shearLevel_]);
}

void ClothModel::addPoints(const PointModel& points, double share, Level& level) const {
  for (const int j : level.lines.rows) {
    for (const int i : level.lines.columns) {
      const std::size_t k = layout_.at(i, j);
      const bool moves = points.free[k] > 0 && points.mass[k] > 0;
      level.lightness.push_back(moves ? share / points.mass[k] : 0);
    }
  }
}

void ClothModel::addEdges(const ElasticGrid& elastic, double strips, Level& level) const {
  const ElasticGrid::Coefficients& c = elastic.coefficients();
  const auto chain = [&](int first, int last, const FloatArray& weight, const FloatArray& squared,
                         const auto& at) {
    Edge edge;
    double give = 0;
    for (int n = first; n < last; ++n) {
      const std::size_t k = at(n);
      if (!(weight[k] > 0)) continue;
      edge.length_m += std::sqrt(double{squared[k]});
      give += 1 / (2 * double{weight[k]} * squared[k]);
    }
    edge.stiffness_N_per_m = give > 0 ? strips / give : 0;
    return edge;
  };
  const std::vector<int>&columns = level.lines.columns, &rows = level.lines.rows;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const bool last = i + 1 == columns.size() && !layout_.closed;
      const int next = last ? columns[i] : lineAfter(columns, i, layout_.columns);
      level.along.push_back(
          chain(columns[i], next, c.w1, c.g1, [&](int n) { return layout_.at(n, rows[j]); }));
      const int above = j + 1 < rows.size() ? rows[j + 1] : rows[j];
      level.above.push_back(
          chain(rows[j], above, c.w2, c.g2, [&](int n) { return layout_.at(columns[i], n); }));
    }
  }
}

void ClothModel::addCells(const ElasticGrid& elastic, const VectorArray& rest, Level& level) const {
  const ElasticGrid::Coefficients& c = elastic.coefficients();
  const std::vector<int>&columns = level.lines.columns, &rows = level.lines.rows;
  level.cells.resize(columns.size() * rows.size());
  for (std::size_t j = 0; j + 1 < rows.size(); ++j) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i + 1 == columns.size() && !layout_.closed) continue;
      const int next = lineAfter(columns, i, layout_.columns);
      double stiffness = 0;
      int count = 0;
      for (int r = rows[j]; r < rows[j + 1]; ++r)
        for (int n = columns[i]; n < next; ++n, ++count)
          stiffness += double{c.w12[layout_.at(n, r)]} * c.lim12[layout_.at(n, r)] / c.cap;
      const auto diagonal = [&](int from, int to) {
        return (pointAt(rest, layout_.at(layout_.wrapped(to), rows[j + 1])) -
                pointAt(rest, layout_.at(layout_.wrapped(from), rows[j])))
            .norm();
      };
      // Relaxed, as the edges are.
      const double length = elastic.restLengthU_m(columns[i], rows[j]);
      const double relaxed = std::sqrt(double{c.g1[layout_.at(columns[i], rows[j])]});
      const double shrink = length > 0 && relaxed > 0 ? relaxed / length : 1;
      level.cells[index(level, i, j)] = {shrink * diagonal(columns[i], next),
                                         shrink * diagonal(next, columns[i]), stiffness / count};
    }
  }
}

std::size_t ClothModel::levelFor(std::size_t side) const {
  const auto small = std::ranges::find_if(levels_, [&](const Level& level) {
    return std::min(level.lines.columns.size(), level.lines.rows.size()) <= side;
  });
  return small == levels_.end() ? levels_.size() - 1
                                : static_cast<std::size_t>(small - levels_.begin());
}

std::vector<ClothLevel> ClothModel::makeLevels() const {
  std::vector<ClothLevel> out(levels_.size());
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const GridLines& lines = levels_[l].lines;
    out[l].resize(static_cast<int>(lines.columns.size()), static_cast<int>(lines.rows.size()),
                  layout_.closed);
    if (l > 0) link(levels_[l - 1], levels_[l], out[l - 1], out[l]);
  }
  return out;
}

// Which rows and columns of two neighbouring levels belong together.
void ClothModel::link(const Level& fine, const Level& coarse, ClothLevel& finer,
                      ClothLevel& coarser) {
  coarser.extraColumn = coarse.lines.columns.size() > finer.evens();
  if (coarser.extraColumn) finer.oddShare[finer.odds() - 1] = 1;
  const std::vector<int>&rows = fine.lines.rows, &held = coarse.lines.rows;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const auto above = std::ranges::upper_bound(held, rows[j]);
    const auto at = std::min(above - held.begin() - 1, static_cast<long>(held.size()) - 2);
    const int low = held[static_cast<std::size_t>(at)],
              high = held[static_cast<std::size_t>(at) + 1];
    ClothLevel::Row& row = finer.row[j];
    row.coarser = static_cast<int>(at);
    row.share = static_cast<float>(rows[j] - low) / static_cast<float>(high - low);
    row.onCoarser = rows[j] == low ? row.coarser : rows[j] == high ? row.coarser + 1 : -1;
    if (row.onCoarser >= 0) coarser.finerRow.push_back(static_cast<int>(j));
  }
}

void ClothModel::prepare(double h, double lead, std::vector<ClothLevel>& levels) const {
  FASCIA_ASSERT(h > 0 && levels.size() == levels_.size(), "the levels of this sheet");
  for (std::size_t l = 0; l < levels.size(); ++l) {
    ClothLevel& out = levels[l];
    out.tables.clear();
    FloatArray lists[3];
    for (std::size_t j = 0; j < out.row.size(); ++j) {
      const ClothLevel::Row before = out.row[j > 0 ? j - 1 : 0];
      fillRow(levels_[l], j, l == shearLevel_, 1 / (lead * h * h), out, lists);
      out.row[j].inside = stored(lists[0], before.inside, j > 0, out.tables);
      out.row[j].above = stored(lists[1], before.above, j > 0, out.tables);
      out.row[j].shear = lists[2].empty() ? 0 : stored(lists[2], before.shear, j > 0, out.tables);
    }
  }
}

// `compliance`: of a stiffness of 1 N/m.
void ClothModel::fillRow(const Level& level, std::size_t j, bool sheared, double compliance,
                         ClothLevel& out, FloatArray (&lists)[3]) const {
  lists[0].assign(6 * out.half, 0.f);
  lists[1].assign(6 * out.half, 0.f);
  lists[2].assign(sheared ? 12 * out.half : 0, 0.f);
  LimitLists inside(lists[0], out.half), above(lists[1], out.half), shear(lists[2], out.half);
  ShareRule rule;
  const std::size_t columns = level.lines.columns.size();
  for (std::size_t i = 0; i < columns; ++i) {
    const std::size_t p = index(level, i, j), right = index(level, (i + 1) % columns, j);
    const bool seam = i + 1 == columns;
    const double own = level.lightness[p];
    const auto limit = [&](const Edge& edge, std::size_t other) {
      const double give = edge.length_m > 0 ? compliance / edge.stiffness_N_per_m : 0;
      return rule(own, level.lightness[other], give, edge.length_m);
    };
    const Limit along = limit(level.along[p], right);
    if (seam)
      out.row[j].seam = along;
    else
      inside.set(i % 2, i / 2, along);
    if (j + 1 == level.lines.rows.size()) continue;
    above.set(i % 2, i / 2, limit(level.above[p], p + columns));
    if (!sheared || level.cells[p].stiffness_N_per_m == 0) continue;
    const Cell& cell = level.cells[p];
    const double give = compliance / cell.stiffness_N_per_m;
    const Limit up = ShareRule::alone(own, level.lightness[right + columns], give, cell.up_m);
    const Limit down =
        ShareRule::alone(level.lightness[right], level.lightness[p + columns], give, cell.down_m);
    if (seam) {
      out.row[j].seamUp = up, out.row[j].seamDown = down;
      continue;
    }
    shear.set(2 * (i % 2), i / 2, up);
    shear.set(2 * (i % 2) + 1, i / 2, down);
  }
}

}  // namespace fascia
