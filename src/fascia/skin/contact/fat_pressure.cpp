#include <fascia/skin/contact/fat_pressure.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Fat that is as thick as the body under it is round ends in a point: a cone has this share of a
// prism's volume. Thicker fat has no less.
constexpr double kCone = 1.0 / 3;

using Triangles = std::span<const TriangleMembrane::Corners>;

// Adds to each point `share` of a third of the area vectors of its triangles, m².
void addAreaVectors(Triangles triangles, const VectorArray& r, float share, VectorArray& area) {
  const float sixth = share / 6;
  for (const auto& [a, b, c] : triangles) {
    const float x1 = r.x[b] - r.x[a], y1 = r.y[b] - r.y[a], z1 = r.z[b] - r.z[a];
    const float x2 = r.x[c] - r.x[a], y2 = r.y[c] - r.y[a], z2 = r.z[c] - r.z[a];
    const float x = sixth * (y1 * z2 - z1 * y2), y = sixth * (z1 * x2 - x1 * z2),
                z = sixth * (x1 * y2 - y1 * x2);
    for (const std::uint32_t k : {a, b, c}) area.x[k] += x, area.y[k] += y, area.z[k] += z;
  }
}

// N̄ between two shapes; `halfway` is scratch of their size.
void meanAreaVectors(Triangles triangles, const VectorArray& inner, const VectorArray& outer,
                     VectorArray& halfway, VectorArray& mean) {
  mean.fill(0.f);
  addAreaVectors(triangles, inner, 1.f / 6, mean);
  addAreaVectors(triangles, outer, 1.f / 6, mean);
  for (const auto axis : VectorArray::kAxes)
    for (std::size_t k = 0; k < halfway.size(); ++k)
      (halfway.*axis)[k] = 0.5f * ((inner.*axis)[k] + (outer.*axis)[k]);
  addAreaVectors(triangles, halfway, 4.f / 6, mean);
}

// N·(to − from)
float heightOver(const VectorArray& area, const VectorArray& from, const VectorArray& to,
                 std::size_t k) {
  return area.x[k] * (to.x[k] - from.x[k]) + area.y[k] * (to.y[k] - from.y[k]) +
         area.z[k] * (to.z[k] - from.z[k]);
}

// The same, over what has moved from `from` with its velocity.
float heightOver(const VectorArray& area, const VectorArray& from, const VectorArray& velocity,
                 float time_s, const VectorArray& to, std::size_t k) {
  return area.x[k] * (to.x[k] - (from.x[k] + time_s * velocity.x[k])) +
         area.y[k] * (to.y[k] - (from.y[k] + time_s * velocity.y[k])) +
         area.z[k] * (to.z[k] - (from.z[k] + time_s * velocity.z[k]));
}

float square(const VectorArray& area, std::size_t k) {
  return area.x[k] * area.x[k] + area.y[k] * area.y[k] + area.z[k] * area.z[k];
}

// Moves points inward by the thickness of their fat.
void takeFatAway(const FloatArray& fat, const VectorArray& area, VectorArray& r) {
  for (std::size_t k = 0; k < r.size(); ++k) {
    const float length = std::sqrt(square(area, k));
    if (!(length > 0)) continue;
    const float by = fat[k] / length;
    for (const auto axis : VectorArray::kAxes) (r.*axis)[k] -= by * (area.*axis)[k];
  }
}

std::span<const std::uint32_t> pointsOf(const FatPressureModel& model,
                                        const FatPressureModel::Layer& layer) {
  return std::span(model.points).subspan(layer.first, layer.count);
}

void measureFat(const FatPressureInput& input, FatPressureModel& model) {
  const VectorArray& rest = input.rest;
  VectorArray area(rest.size()), halfway(rest.size()), mean(rest.size());
  VectorArray inner = rest;
  addAreaVectors(model.triangles, rest, 1, area);
  takeFatAway(input.fat, area, inner);
  meanAreaVectors(model.triangles, inner, rest, halfway, mean);
  for (FatPressureModel::Layer& layer : model.layers) {
    for (const std::uint32_t k : pointsOf(model, layer)) {
      const double prism = std::sqrt(double{square(area, k)}) * double{input.fat[k]};
      layer.volume_m3 += std::max(double{heightOver(mean, inner, rest, k)}, kCone * prism);
    }
  }
  std::erase_if(model.layers, [](const auto& layer) { return !(layer.volume_m3 > 0); });
}

double volumeBetween(const VectorArray& mean, const VectorArray& inner, const VectorArray& outer,
                     std::span<const std::uint32_t> points) {
  double sum = 0;
  for (const std::uint32_t k : points) sum += double{heightOver(mean, inner, outer, k)};
  return sum;
}

}  // namespace

FatPressureModel prepareFatPressure(const FatPressureInput& input) {
  FASCIA_ASSERT(input.solid.size() <= input.rest.size() && input.bulk_Pa > 0,
                "every point has a solid or none");
  FatPressureModel model;
  model.bulk_Pa = input.bulk_Pa;
  model.reachesAnchors = input.reachesAnchors;

  std::vector<char> inLayer(input.rest.size(), 0);
  for (std::size_t k = 0; k < input.solid.size(); ++k)
    inLayer[k] = input.solid[k].valid() && input.fat[k] > 0 && input.points.free[k] > 0;
  for (std::size_t k = 0; k < input.solid.size(); ++k)
    if (inLayer[k]) model.points.push_back(static_cast<std::uint32_t>(k));
  std::stable_sort(model.points.begin(), model.points.end(),
                   [&](auto a, auto b) { return input.solid[a].index() < input.solid[b].index(); });
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    if (i == 0 || input.solid[model.points[i]] != input.solid[model.points[i - 1]])
      model.layers.push_back({static_cast<std::uint32_t>(i), 0, 0, 0});
    ++model.layers.back().count;
  }
  std::copy_if(input.triangles.begin(), input.triangles.end(), std::back_inserter(model.triangles),
               [&](const TriangleMembrane::Corners& t) {
                 return inLayer[t[0]] || inLayer[t[1]] || inLayer[t[2]];
               });
  measureFat(input, model);
  if (!model.reachesAnchors) return model;
  VectorArray halfway(input.rest.size()), mean(input.rest.size());
  meanAreaVectors(model.triangles, input.anchor, input.rest, halfway, mean);
  for (FatPressureModel::Layer& layer : model.layers)
    layer.rest_m3 = volumeBetween(mean, input.anchor, input.rest, pointsOf(model, layer));
  return model;
}

FatPressure::FatPressure(const FatPressureModel& model, std::size_t storage)
    : model_(&model), interval_(model.layers.size()), pressures_(model.layers.size()) {
  for (VectorArray* a : {&area_, &force_, &carried_, &carriedVelocity_, &halfway_, &meanArea_})
    a->resize(storage);
}

void FatPressure::begin(const StepCoefficients& step, const Way& way, const VectorArray& position) {
  const std::size_t count = area_.size();
  FASCIA_ASSERT(step.step_s > 0 && way.duration_s > 0, "time goes on");
  FASCIA_ASSERT(
      position.size() == count && way.carried.size() == count && way.carriedToEnd.size() == count,
      "the state is of this skin, and so is what carries it");
  step_ = &step;
  carried_ = way.carried;
  const auto rate = static_cast<float>(1 / way.duration_s);
  for (const auto axis : VectorArray::kAxes) {
    for (std::size_t k = 0; k < count; ++k) {
      const float by = (way.carriedToEnd.*axis)[k] - (way.carried.*axis)[k];
      (carriedVelocity_.*axis)[k] = rate * by;
      (halfway_.*axis)[k] = (way.carried.*axis)[k] + 0.5f * by;
    }
  }
  area_.fill(0.f);
  addAreaVectors(model_->triangles, halfway_, 1, area_);
  measureCarried(way);
  for (std::size_t l = 0; l < model_->layers.size(); ++l) {
    const FatPressureModel::Layer& layer = model_->layers[l];
    double answer = 0;
    for (const std::uint32_t k : pointsOf(*model_, layer))
      answer += double{square(area_, k) * step.gain[k]};
    interval_[l].answer = double{step.step_s} * answer;
    pressures_[l] = held_Pa(-model_->bulk_Pa / layer.volume_m3 * change_m3(l, 0, position));
    push(layer, pressures_[l]);
  }
}

// V_c and its rate, where it counts.
void FatPressure::measureCarried(const Way& way) {
  std::fill(interval_.begin(), interval_.end(), Interval{0, 0, 0});
  if (!model_->reachesAnchors) return;
  meanAreaVectors(model_->triangles, way.anchor, way.carried, halfway_, meanArea_);
  for (std::size_t l = 0; l < model_->layers.size(); ++l)
    interval_[l].carried_m3 =
        volumeBetween(meanArea_, way.anchor, way.carried, pointsOf(*model_, model_->layers[l])) -
        model_->layers[l].rest_m3;
  meanAreaVectors(model_->triangles, way.anchorAtEnd, way.carriedToEnd, halfway_, meanArea_);
  for (std::size_t l = 0; l < model_->layers.size(); ++l) {
    const double end_m3 = volumeBetween(meanArea_, way.anchorAtEnd, way.carriedToEnd,
                                        pointsOf(*model_, model_->layers[l])) -
                          model_->layers[l].rest_m3;
    interval_[l].rate_m3_per_s = (end_m3 - interval_[l].carried_m3) / way.duration_s;
  }
}

// ΔV
double FatPressure::change_m3(std::size_t layer, float time_s, const VectorArray& position) const {
  double sum = interval_[layer].carried_m3 + double{time_s} * interval_[layer].rate_m3_per_s;
  for (const std::uint32_t k : pointsOf(*model_, model_->layers[layer]))
    sum += double{heightOver(area_, carried_, carriedVelocity_, time_s, position, k)};
  return sum;
}

void FatPressure::stepped(float time_s, VectorArray& position, VectorArray& velocity) {
  FASCIA_ASSERT(step_, "begin() comes first");
  for (std::size_t l = 0; l < model_->layers.size(); ++l) {
    const FatPressureModel::Layer& layer = model_->layers[l];
    const double stiffness_Pa_per_m3 = model_->bulk_Pa / layer.volume_m3;
    const double wanted_Pa = -stiffness_Pa_per_m3 * change_m3(l, time_s, position);
    const double before_Pa = pressures_[l];
    pressures_[l] = held_Pa(before_Pa + (wanted_Pa - before_Pa) /
                                            (1 + stiffness_Pa_per_m3 * interval_[l].answer));
    const auto by = static_cast<float>(pressures_[l] - before_Pa);
    for (const std::uint32_t k : pointsOf(*model_, layer)) {
      const float gain = by * step_->gain[k];
      for (const auto axis : VectorArray::kAxes) {
        const float change = gain * (area_.*axis)[k];
        (velocity.*axis)[k] += change;
        (position.*axis)[k] += step_->step_s * change;
      }
    }
    push(layer, pressures_[l]);
  }
}

// No layer is pressed to nothing or to more than twice its volume.
double FatPressure::held_Pa(double pressure_Pa) const {
  return std::clamp(pressure_Pa, -model_->bulk_Pa, model_->bulk_Pa);
}

void FatPressure::push(const FatPressureModel::Layer& layer, double pressure_Pa) {
  const auto p = static_cast<float>(pressure_Pa);
  for (const std::uint32_t k : pointsOf(*model_, layer))
    for (const auto axis : VectorArray::kAxes) (force_.*axis)[k] = p * (area_.*axis)[k];
}

}  // namespace fascia
