#include <fascia/deformable/solve/redundancy.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

namespace fascia {
namespace {

// Entries of a dependence below this are rounding.
constexpr double kNegligible = 1e-9;
// Demands that differ by less than this agree.
constexpr double kAgreement_m = 1e-9;

}  // namespace

bool Redundancy::contradicts() const {
  return conflict_m > kAgreement_m;
}

std::string Redundancy::text() const {
  std::string message = std::string("constraint '") + constraint +
                        "': " + std::to_string(row_count) +
                        (row_count == 1 ? " row follows" : " rows follow");
  for (std::size_t i = 0; i < others.size(); ++i)
    message += (i == 0 ? " from '" : ", '") + others[i] + "'";
  if (others.empty()) message += " from what cannot move anyway";
  if (contradicts()) {
    char distance[32];
    std::snprintf(distance, sizeof distance, "%.3g", conflict_m);
    message += std::string(", but it wants a place ") + distance + " m away";
  }
  return message;
}

void Redundancies::find(const BlockCholesky& matrix, const ConstraintList& list) {
  rows_.clear();
  const std::size_t count = matrix.blockCount();
  std::vector<Vec3> n(count);
  std::vector<std::vector<int>> rowsOfBlocks(count);
  for (std::size_t block = 0; block < count; ++block) {
    for (int r = 0; r < list.rowCount(block); ++r) {
      if ((matrix.dropped()[block] >> r & 1) == 0) continue;
      matrix.dependence(static_cast<int>(block), r, n);
      Row row{static_cast<int>(block), {}};
      for (std::size_t i = 0; i < count; ++i) {
        if (n[i].cwiseAbs().maxCoeff() <= kNegligible) continue;
        row.entries.push_back({static_cast<int>(i), n[i]});
        rowsOfBlocks[i].push_back(static_cast<int>(rows_.size()));
      }
      rows_.push_back(std::move(row));
    }
  }
  std::map<std::pair<int, int>, double> products;  // of N Nᵀ, lower triangle
  const auto weightsOf = [&](int row, int block) {
    const auto& entries = rows_[static_cast<std::size_t>(row)].entries;
    return std::ranges::find(entries, block, &Entry::block)->weights;
  };
  for (std::size_t block = 0; block < count; ++block)
    for (const int a : rowsOfBlocks[block])
      for (const int b : rowsOfBlocks[block])
        if (a >= b)
          products[{a, b}] +=
              weightsOf(a, static_cast<int>(block)).dot(weightsOf(b, static_cast<int>(block)));
  std::vector<std::pair<int, int>> pattern;
  for (const auto& [pair, product] : products)
    if (pair.first != pair.second) pattern.push_back(pair);
  normal_.setPattern(rows_.size(), pattern);
  for (const auto& [pair, product] : products) {
    Mat3 value = pair.first == pair.second ? Mat3(Mat3::Identity()) : Mat3(Mat3::Zero());
    value(0, 0) = product;
    normal_.add(pair.first, pair.second, value);
  }
  normal_.factorizeAndFindDependent(0);
  multipliers_.resize(rows_.size());
}

double Redundancies::product(const Row& row, std::span<const Vec3> b) const {
  double sum = 0;
  for (const Entry& entry : row.entries)
    sum += entry.weights.dot(b[static_cast<std::size_t>(entry.block)]);
  return sum;
}

void Redundancies::makeSolvable(std::span<Vec3> b) const {
  if (rows_.empty()) return;
  for (std::size_t i = 0; i < rows_.size(); ++i) multipliers_[i] = Vec3(product(rows_[i], b), 0, 0);
  normal_.solve(multipliers_);
  for (std::size_t i = 0; i < rows_.size(); ++i)
    for (const Entry& entry : rows_[i].entries)
      b[static_cast<std::size_t>(entry.block)] -= multipliers_[i].x() * entry.weights;
}

std::vector<Redundancy> Redundancies::describe(const ConstraintList& list) const {
  std::vector<Vec3> values(list.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = list.rows(i).value;
  std::vector<Redundancy> found;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    if (i == 0 || rows_[i - 1].block != row.block)
      found.push_back({list.constraint(static_cast<std::size_t>(row.block)).name(), 0, {}, 0});
    Redundancy& redundancy = found.back();
    ++redundancy.row_count;
    redundancy.conflict_m = std::hypot(redundancy.conflict_m, product(row, values));
    for (const Entry& entry : row.entries) {
      const std::string& name = list.constraint(static_cast<std::size_t>(entry.block)).name();
      const bool known = std::ranges::find(redundancy.others, name) != redundancy.others.end();
      if (entry.block != row.block && !known) redundancy.others.push_back(name);
    }
  }
  return found;
}

}  // namespace fascia
