#include <fascia/skin/cloth/cloth_bending.h>

#include <fascia/base/assert.h>
#include <fascia/skin/grid/elastic_grid.h>

namespace fascia {

ClothBending::ClothBending(const Source& source)
    : layout_{static_cast<int>(source.lines.columns.size()),
              static_cast<int>(source.lines.rows.size()), source.layout.closed},
      position_(layout_.storage()),
      force_(layout_.storage()) {
  VectorArray rest(layout_.storage());
  FloatArray stiffness_Nm(layout_.storage(), 0.f);
  for (int j = 0; j < layout_.rows; ++j) {
    for (int i = 0; i < layout_.columns; ++i) {
      const std::size_t to = layout_.at(i, j);
      const std::size_t from = source.layout.at(source.lines.columns[static_cast<std::size_t>(i)],
                                                source.lines.rows[static_cast<std::size_t>(j)]);
      for (const auto axis : VectorArray::kAxes) (rest.*axis)[to] = (source.rest.*axis)[from];
      stiffness_Nm[to] = source.stiffness_Nm[from];
      const bool moves = source.points.free[from] > 0;
      mass_kg_.push_back(moves ? source.share * source.points.mass[from] : 0);
    }
  }
  fillPads(layout_, rest);
  bending_ = Bending(layout_, rest, stiffness_Nm);
  for (FloatArray& way : way_) way.resize(mass_kg_.size());
}

void ClothBending::prepare(double squaredStep_s2) {
  squaredStep_s2_ = squaredStep_s2;
  if (!active()) return;
  std::vector<Eigen::Triplet<double>> stiffness, entries;
  bending_.addStiffness(stiffness);
  const auto moves = [&](int point) { return mass_kg_[static_cast<std::size_t>(point)] > 0; };
  for (const Eigen::Triplet<double>& entry : stiffness)
    if (moves(entry.row()) && moves(entry.col()))
      entries.emplace_back(entry.row(), entry.col(), squaredStep_s2 * entry.value());
  const auto count = static_cast<int>(mass_kg_.size());
  for (int point = 0; point < count; ++point)
    entries.emplace_back(point, point,
                         moves(point) ? mass_kg_[static_cast<std::size_t>(point)] : 1);
  SparseMatrix matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  [[maybe_unused]] const bool definite = factor_.factorize(matrix);
  FASCIA_ASSERT(definite, "masses on the diagonal, and no stiffness below zero");
}

void ClothBending::apply(VectorArray& place, const ClothLevel& level) {
  FASCIA_ASSERT(level.columns == layout_.columns && level.rows == layout_.rows, "of this level");
  const auto forEach = [&](const auto& visit) {
    std::size_t point = 0;
    for (int j = 0; j < layout_.rows; ++j)
      for (int i = 0; i < layout_.columns; ++i, ++point)
        visit(point, layout_.at(i, j), level.at(i, j));
  };
  for (const auto axis : VectorArray::kAxes)
    forEach([&](std::size_t, std::size_t k, std::size_t at) {
      (position_.*axis)[k] = (place.*axis)[at];
    });
  fillPads(layout_, position_);
  force_.fill(0.f);
  bending_.addForces(position_, force_);
  const auto h2 = static_cast<float>(squaredStep_s2_);
  for (std::size_t a = 0; a < 3; ++a) {
    const FloatArray& force = force_.*VectorArray::kAxes[a];
    forEach([&](std::size_t p, std::size_t k, std::size_t) {
      way_[a][p] = mass_kg_[p] > 0 ? h2 * force[k] : 0.f;
    });
  }
  factor_.solve(way_[0], way_[1], way_[2], scratch_);
  for (std::size_t a = 0; a < 3; ++a)
    forEach([&](std::size_t p, std::size_t, std::size_t at) {
      (place.*VectorArray::kAxes[a])[at] += way_[a][p];
    });
}

}  // namespace fascia
