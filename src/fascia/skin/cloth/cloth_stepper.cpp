#include <fascia/skin/cloth/cloth_stepper.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Share of a step's acceleration that its own way shows (see cloth_stepper.h).
constexpr double kLead = 1 / (1 + ClothStepper::kSwing);
// Rows of a band, at least: bands are swept on their own, and what passes between two waits for the
// sweep back.
constexpr int kBandRows = 24;
// Levels of fewer points are not worth waking threads for.
constexpr int kParallelPoints = 4096;
// Bending acts on the finest level with no more rows or columns: solving for a larger one would
// take longer than all that the sweeps do.
constexpr std::size_t kBendingSide = 33;
// Pairs of sweeps of the coarsest level; more hardly help.
constexpr int kCoarsestSweeps = 2;

bool isLarge(const ClothLevel& level) {
  return level.rows * level.columns >= kParallelPoints;
}

}  // namespace

ClothStepper::ClothStepper(const GridTopology& grid, const VectorArray& rest,
                           const PointModel& points, const FloatArray& bending_Nm)
    : grid_(grid), model_(grid.elastic(), rest, points), levels_(model_.makeLevels()) {
  for (VectorArray* a : {&motion_.end, &motion_.velocity}) *a = VectorArray(levels_[0].storage());
  motion_.row.resize(levels_[0].row.size());
  motion_.hasStrands.resize(levels_[0].row.size());
  if (!grid.bending().active()) return;
  bendingLevel_ = model_.levelFor(kBendingSide);
  const double strips = std::pow(2.0, static_cast<double>(bendingLevel_));
  bending_ = ClothBending(
      {grid.layout(), model_.lines(bendingLevel_), rest, bending_Nm, points, strips * strips});
}

void ClothStepper::forces(const VectorArray& position, VectorArray& force) {
  if (!forces_) forces_ = grid_.makeStepper();
  forces_->forces(position, force);
}

void ClothStepper::prepare(const StepInputs& inputs) {
  const double h = inputs.step->step_s;
  FASCIA_ASSERT(h > 0, "a step lasts");
  if (prepared_s_ == h) return;
  model_.prepare(h, kLead, levels_);
  prepareMotion(*inputs.points, h);
  bending_.prepare(kLead * h * h);
  prepared_s_ = h;
}

// Drag, gravity and strands of the finest level's points.
void ClothStepper::prepareMotion(const PointModel& p, double h) {
  const ClothLevel& level = levels_[0];
  const GridLayout& g = grid_.layout();
  motion_.tables.clear();
  FloatArray lists;
  for (int j = 0; j < g.rows; ++j) {
    lists.assign(10 * level.half, 0.f);
    bool strands = false;
    for (int i = 0; i < g.columns; ++i) {
      const std::size_t k = g.at(i, j), at = level.at(i, 0);
      const auto set = [&](std::size_t list, double value) {
        lists[2 * list * level.half + at] = static_cast<float>(value);
      };
      set(0, 1);
      if (!(p.free[k] > 0)) continue;
      const double mass = p.mass[k];
      set(0, std::max(0.0, 1 - kLead * h * p.drag[k] / mass));
      set(1, kLead * h * h);
      const double pull = kLead * h * h * p.tissueStiffness[k],
                   damp = kLead * h * p.tissueDamping[k];
      if (pull == 0 && damp == 0) continue;
      strands = true;
      set(2, pull / (mass + pull));
      set(3, damp / (mass + damp));
      set(4, p.tissueRestLength[k]);
    }
    if (!strands) lists.resize(4 * level.half);
    const auto row = static_cast<std::size_t>(j);
    motion_.hasStrands[row] = strands ? 1 : 0;
    const std::size_t before = row > 0 ? motion_.row[row - 1] : 0;
    const bool same =
        row > 0 && before + lists.size() <= motion_.tables.size() &&
        motion_.hasStrands[row - 1] == motion_.hasStrands[row] &&
        std::equal(lists.begin(), lists.end(), motion_.tables.begin() + static_cast<long>(before));
    motion_.row[row] = same ? before : motion_.tables.size();
    if (!same) motion_.tables.insert(motion_.tables.end(), lists.begin(), lists.end());
  }
}

void ClothStepper::run(const StepInputs& inputs, int firstStep, int steps, VectorArray& position,
                       VectorArray& velocity) {
  FASCIA_ASSERT(!inputs.extraForce, "only meshes have fat that presses");
  FASCIA_ASSERT(steps > 0 && position.size() == grid_.storage(), "the state is of this grid");
  prepare(inputs);
  ClothStep s;
  s.inputs = &inputs;
  s.layout = &grid_.layout();
  s.step_s = inputs.step->step_s;
  s.swing = static_cast<float>(kSwing);
  s.position = &position;
  s.velocity = &velocity;
  // Resting points come this near between two steps.
  const float* g = inputs.gravity;
  s.touch_m = 0.1f * s.step_s * s.step_s * std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  s.time_s = static_cast<float>(firstStep + 1) * s.step_s;
  forBands(levels_[0], 0, [&](int begin, int end) { clothBegin(s, levels_, motion_, begin, end); });
  for (int n = firstStep; n < firstStep + steps; ++n) {
    s.time_s = static_cast<float>(n + 1) * s.step_s;
    s.isLast = n + 1 == firstStep + steps;
    step(s, n);
  }
}

void ClothStepper::step(const ClothStep& s, int number) {
  for (std::size_t l = levels_.size(); l-- > 0;) sweepLevel(l, s, number);
}

void ClothStepper::sweepLevel(std::size_t l, const ClothStep& s, int number) {
  ClothLevel& level = levels_[l];
  const bool coarsest = l + 1 == levels_.size();
  const bool adjusted = l == model_.shearLevel() || bends(l);
  if (adjusted) adjust(l, number);
  const int sweeps = coarsest && l > 0 ? kCoarsestSweeps : 1;
  for (int n = 0; n < sweeps; ++n) {
    const ClothLevel* coarser = n > 0 || coarsest || adjusted ? nullptr : &levels_[l + 1];
    const auto down = [&](int begin, int end) {
      clothSweepDown(coarser, level, s.time_s, begin, end);
    };
    const auto up = [&](int begin, int end) {
      if (n + 1 < sweeps)
        clothSweepUp(level, s.time_s, begin, end);
      else if (l > 0)
        clothFinishCoarse(levels_[l - 1], level, s.time_s, begin, end);
      else
        clothFinish(s, levels_, motion_, begin, end);
    };
    thereAndBack(level, Bands(level, number), down, up);
  }
}

// All bands down, then the edges between them, then all bands up; in an order that comes back to a
// band while it is in the cache. Bands up do not touch each other.
template <class Down, class Up>
void ClothStepper::thereAndBack(ClothLevel& level, const Bands& bands, const Down& down,
                                const Up& up) {
  const int chunks = isLarge(level) ? std::min(bands.count, threadLimit()) : 1;
  const auto chunkStart = [&](std::size_t chunk) {
    return bands.count * static_cast<int>(chunk) / chunks;
  };
  const auto upBand = [&](int band) { up(bands.start(band), bands.start(band + 1)); };
  parallelFor(static_cast<std::size_t>(chunks), [&](std::size_t chunk) {
    const int first = chunkStart(chunk), end = chunkStart(chunk + 1);
    for (int b = first; b < end; ++b) {
      down(bands.start(b), bands.start(b + 1));
      if (b == first) continue;
      clothSeam(level, bands.start(b));
      if (b - 1 > first || first == 0) upBand(b - 1);
    }
    if (end == bands.count && (end - 1 > first || first == 0)) upBand(end - 1);
  });
  if (chunks == 1) return;
  for (int c = 1; c < chunks; ++c)
    clothSeam(level, bands.start(chunkStart(static_cast<std::size_t>(c))));
  parallelFor(static_cast<std::size_t>(chunks), [&](std::size_t chunk) {
    const int first = chunkStart(chunk), last = chunkStart(chunk + 1) - 1;
    if (first > 0) upBand(first);
    if (last + 1 < bands.count && (last > first || first == 0)) upBand(last);
  });
}

// What acts once per step on one level, before its sweeps.
void ClothStepper::adjust(std::size_t l, int number) {
  ClothLevel& level = levels_[l];
  if (l + 1 < levels_.size())
    forBands(level, number,
             [&](int begin, int end) { clothFollow(levels_[l + 1], level, begin, end); });
  if (bends(l)) bending_.apply(level.place, level);
  if (l != model_.shearLevel()) return;
  forBands(level, number, [&](int begin, int end) { clothShear(level, begin, end - 1); });
  const Bands bands(level, number);
  for (int b = 1; b < bands.count; ++b) clothShear(level, bands.start(b) - 1, bands.start(b));
}

ClothStepper::Bands::Bands(const ClothLevel& level, int number)
    : count(std::max(1, level.rows / kBandRows)),
      rows(level.rows),
      shift((number % 3 - 1) * (level.rows / count / 3)) {}

int ClothStepper::Bands::start(int band) const {
  if (band == 0) return 0;
  if (band == count) return rows;
  return rows * band / count + shift;
}

// task(begin, end) for the rows of each band.
template <class Task>
void ClothStepper::forBands(const ClothLevel& level, int number, const Task& task) {
  const Bands bands(level, number);
  if (!isLarge(level)) {
    for (int b = 0; b < bands.count; ++b) task(bands.start(b), bands.start(b + 1));
    return;
  }
  parallelFor(static_cast<std::size_t>(bands.count), [&](std::size_t b) {
    const auto band = static_cast<int>(b);
    task(bands.start(band), bands.start(band + 1));
  });
}

}  // namespace fascia
