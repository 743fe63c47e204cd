#include <fascia/skin/grid/grid_stepper.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Below this many points one tile in place beats copying and waking threads.
constexpr std::size_t kTilingPoints = 4096;
// Rows per tile: enough that the border rows computed twice stay a small share.
constexpr int kTileRows = 32;
// Steps per visit of a tile: each costs one more border row on both sides.
constexpr int kStepsPerVisit = 4;

void copyRows(const GridLayout& g, const VectorArray& from, int fromFirst, VectorArray& to,
              int toFirst, int begin, int end) {
  FASCIA_ASSERT(fromFirst <= begin && toFirst <= begin && begin <= end && end <= g.rows,
                "rows of the grid");
  const std::size_t count = static_cast<std::size_t>(end - begin) * g.stride();
  const std::size_t source = static_cast<std::size_t>(begin - fromFirst) * g.stride();
  const std::size_t target = static_cast<std::size_t>(begin - toFirst) * g.stride();
  std::memcpy(to.x.data() + target, from.x.data() + source, count * sizeof(float));
  std::memcpy(to.y.data() + target, from.y.data() + source, count * sizeof(float));
  std::memcpy(to.z.data() + target, from.z.data() + source, count * sizeof(float));
}

SweepBand bandOf(VectorArray& position, VectorArray& velocity, int firstStored) {
  return {{position.x.data(), position.y.data(), position.z.data()},
          {velocity.x.data(), velocity.y.data(), velocity.z.data()},
          firstStored};
}

}  // namespace

GridStepper::GridStepper(const GridLayout& layout) : layout_(layout) {
  const bool tiled = layout.pointCount() >= kTilingPoints && layout.rows >= 2 * kTileRows;
  const int count = tiled ? (layout.rows + kTileRows - 1) / kTileRows : 1;
  tiles_.resize(static_cast<std::size_t>(count));
  for (int t = 0; t < count; ++t) {
    Tile& tile = tiles_[static_cast<std::size_t>(t)];
    tile.begin = layout.rows * t / count;
    tile.end = layout.rows * (t + 1) / count;
    tile.scratch.resize(layout);
    if (!tiled) continue;
    const auto stored = static_cast<std::size_t>(tile.end - tile.begin + 2 * kStepsPerVisit);
    tile.position.resize(stored * layout.stride() + GridLayout::kPad);
    tile.velocity.resize(stored * layout.stride() + GridLayout::kPad);
  }
  if (tiled) {
    nextPosition_.resize(layout.storage());
    nextVelocity_.resize(layout.storage());
  }
}

void GridStepper::run(const SweepModel& model, int firstStep, int steps, VectorArray& position,
                      VectorArray& velocity) {
  const float h = model.inputs.step->step_s;
  FASCIA_ASSERT(
      h > 0 && position.size() == layout_.storage() && velocity.size() == layout_.storage(),
      "the state is of this grid");
  if (tiles_.size() == 1) {
    const SweepBand band = bandOf(position, velocity, 0);
    for (int s = 1; s <= steps; ++s)
      sweepRows(model, band, 0, layout_.rows, static_cast<float>(firstStep + s) * h,
                tiles_[0].scratch);
    return;
  }
  for (int done = 0; done < steps; done += kStepsPerVisit) {
    const int now = std::min(kStepsPerVisit, steps - done);
    parallelFor(tiles_.size(), [&](std::size_t t) {
      runTile(model, firstStep + done, now, tiles_[t], position, velocity);
    });
    std::swap(position, nextPosition_);
    std::swap(velocity, nextVelocity_);
  }
}

void GridStepper::runTile(const SweepModel& model, int firstStep, int steps, Tile& tile,
                          const VectorArray& position, const VectorArray& velocity) {
  const int first = std::max(0, tile.begin - steps),
            last = std::min(layout_.rows, tile.end + steps);
  copyRows(layout_, position, 0, tile.position, first, first, last);
  copyRows(layout_, velocity, 0, tile.velocity, first, first, last);
  const SweepBand band = bandOf(tile.position, tile.velocity, first);
  for (int s = 1; s <= steps; ++s) {
    // Every step invalidates one more border row, except at the ends of the grid itself.
    const int begin = first == 0 ? 0 : first + s, end = last == layout_.rows ? last : last - s;
    sweepRows(model, band, begin, end,
              static_cast<float>(firstStep + s) * model.inputs.step->step_s, tile.scratch);
  }
  copyRows(layout_, tile.position, first, nextPosition_, 0, tile.begin, tile.end);
  copyRows(layout_, tile.velocity, first, nextVelocity_, 0, tile.begin, tile.end);
}

}  // namespace fascia
