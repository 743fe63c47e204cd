#include <fascia/skin/grid/prolongation.h>

#include <algorithm>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Rows handed to a thread at once.
constexpr std::size_t kRowsPerTask = 32;

}  // namespace

std::vector<Prolongation::Taps> Prolongation::makeTaps(int coarse, int fine, bool periodic) {
  std::vector<Taps> taps(static_cast<std::size_t>(fine));
  const double scale = periodic ? static_cast<double>(coarse) / fine
                                : static_cast<double>(coarse - 1) / std::max(1, fine - 1);
  for (int i = 0; i < fine; ++i) {
    const double x = i * scale;
    const int low = std::min(static_cast<int>(x), periodic ? coarse - 1 : coarse - 2);
    const double t = x - low;
    const double weight[4] = {0.5 * t * (-1 + t * (2 - t)), 0.5 * (2 + t * t * (3 * t - 5)),
                              0.5 * t * (1 + t * (4 - 3 * t)), 0.5 * t * t * (t - 1)};
    Taps& out = taps[static_cast<std::size_t>(i)];
    for (int q = 0; q < 4; ++q) {
      const int c = low + q - 1;
      out.index[static_cast<std::size_t>(q)] =
          periodic ? (c + coarse) % coarse : std::clamp(c, 0, coarse - 1);
      out.weight[static_cast<std::size_t>(q)] = static_cast<float>(weight[q]);
    }
  }
  return taps;
}

Prolongation::Prolongation(const GridLayout& coarse, const GridLayout& fine)
    : coarse_(coarse),
      fine_(fine),
      columns_(makeTaps(coarse.columns, fine.columns, fine.closed)),
      rows_(makeTaps(coarse.rows, fine.rows, false)),
      scratch_(static_cast<std::size_t>(fine.rows) * coarse.stride()) {}

void Prolongation::applyAxis(const FloatArray& coarse, FloatArray& fine, std::size_t row,
                             float* blended) const {
  const Taps& along = rows_[row];
  const float* source[4];
  for (std::size_t q = 0; q < 4; ++q) source[q] = coarse.data() + coarse_.row(along.index[q]);
  for (int i = 0; i < coarse_.columns; ++i)
    blended[i] = along.weight[0] * source[0][i] + along.weight[1] * source[1][i] +
                 along.weight[2] * source[2][i] + along.weight[3] * source[3][i];
  float* out = fine.data() + fine_.row(static_cast<int>(row));
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Taps& around = columns_[i];
    out[i] =
        around.weight[0] * blended[around.index[0]] + around.weight[1] * blended[around.index[1]] +
        around.weight[2] * blended[around.index[2]] + around.weight[3] * blended[around.index[3]];
  }
  out[-1] = out[fine_.columns - 1];
  out[fine_.columns] = out[0];
}

void Prolongation::apply(const VectorArray& coarse, VectorArray& fine) {
  fine.resize(fine_.storage());
  const std::size_t tasks = (rows_.size() + kRowsPerTask - 1) / kRowsPerTask;
  parallelFor(tasks, [&](std::size_t t) {
    const std::size_t end = std::min(rows_.size(), (t + 1) * kRowsPerTask);
    for (std::size_t row = t * kRowsPerTask; row < end; ++row) {
      float* scratch = scratch_.data() + row * coarse_.stride();
      applyAxis(coarse.x, fine.x, row, scratch);
      applyAxis(coarse.y, fine.y, row, scratch);
      applyAxis(coarse.z, fine.z, row, scratch);
    }
  });
}

}  // namespace fascia
