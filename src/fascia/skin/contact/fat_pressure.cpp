#include <fascia/skin/contact/fat_pressure.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// A force that is constant over an interval h feeds a swing of frequency ω where
// tan(ωh/2) > ωh: from (ωh)² = 5.43 on. The pressure fades out up to there; strands so firm hold
// the fat in place anyway.
constexpr double kFirmestTissue = 5;

// Adds to each point a third of the area vectors of its triangles, m².
void areaVectors(std::span<const TriangleMembrane::Corners> triangles, const VectorArray& r,
                 VectorArray& area) {
  area.fill(0.f);
  constexpr float kSixth = 1.f / 6;
  for (const auto& [a, b, c] : triangles) {
    const float x1 = r.x[b] - r.x[a], y1 = r.y[b] - r.y[a], z1 = r.z[b] - r.z[a];
    const float x2 = r.x[c] - r.x[a], y2 = r.y[c] - r.y[a], z2 = r.z[c] - r.z[a];
    const float x = kSixth * (y1 * z2 - z1 * y2), y = kSixth * (z1 * x2 - x1 * z2),
                z = kSixth * (x1 * y2 - y1 * x2);
    for (const std::uint32_t k : {a, b, c}) area.x[k] += x, area.y[k] += y, area.z[k] += z;
  }
}

// N·(to − from)
float heightOver(const VectorArray& area, const VectorArray& from, const VectorArray& to,
                 std::size_t k) {
  return area.x[k] * (to.x[k] - from.x[k]) + area.y[k] * (to.y[k] - from.y[k]) +
         area.z[k] * (to.z[k] - from.z[k]);
}

float square(const VectorArray& area, std::size_t k) {
  return area.x[k] * area.x[k] + area.y[k] * area.y[k] + area.z[k] * area.z[k];
}

// What changes nowhere in a run. False for a layer that has no volume or cannot move.
bool measureLayer(const FatPressureInput& input, const VectorArray& area,
                  const std::vector<std::uint32_t>& points, FatPressureModel::Layer& layer) {
  double mobility = 0, stiffness = 0;
  for (std::size_t i = layer.first; i < points.size(); ++i) {
    const std::size_t k = points[i];
    const double square_m4 = square(area, k), mass = input.points.mass[k];
    layer.volume_m3 += std::sqrt(square_m4) * double{input.fat[k]};
    layer.rest_m3 += double{heightOver(area, input.anchor, input.rest, k)};
    mobility += square_m4 / mass;
    stiffness += square_m4 / (mass * mass) * double{input.points.tissueStiffness[k]};
  }
  if (!(layer.volume_m3 > 0 && mobility > 0)) return false;
  layer.tissueRate2_per_s2 = stiffness / mobility;
  return true;
}

}  // namespace

FatPressureModel prepareFatPressure(const FatPressureInput& input) {
  FASCIA_ASSERT(input.solid.size() <= input.rest.size() && input.bulk_Pa > 0,
                "every point has a solid or none");
  FatPressureModel model;
  model.bulk_Pa = input.bulk_Pa;
  VectorArray area(input.rest.size());
  areaVectors(input.triangles, input.rest, area);

  const auto hasFat = [&](std::size_t k) {
    return input.solid[k].valid() && input.fat[k] > 0 && input.points.free[k] > 0;
  };
  std::vector<std::uint32_t> sorted;
  for (std::size_t k = 0; k < input.solid.size(); ++k)
    if (hasFat(k)) sorted.push_back(static_cast<std::uint32_t>(k));
  std::stable_sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    return input.solid[a].index() < input.solid[b].index();
  });

  std::vector<char> inLayer(input.rest.size(), 0);
  for (std::size_t i = 0, j; i < sorted.size(); i = j) {
    for (j = i + 1; j < sorted.size() && input.solid[sorted[j]] == input.solid[sorted[i]];) ++j;
    const auto first = static_cast<std::uint32_t>(model.points.size());
    FatPressureModel::Layer layer{first, static_cast<std::uint32_t>(j - i), 0, 0, 0};
    model.points.insert(model.points.end(), sorted.begin() + static_cast<std::ptrdiff_t>(i),
                        sorted.begin() + static_cast<std::ptrdiff_t>(j));
    if (!measureLayer(input, area, model.points, layer)) {
      model.points.resize(first);
      continue;
    }
    model.layers.push_back(layer);
    for (std::size_t p = first; p < model.points.size(); ++p) inLayer[model.points[p]] = 1;
  }
  std::copy_if(input.triangles.begin(), input.triangles.end(), std::back_inserter(model.triangles),
               [&](const TriangleMembrane::Corners& t) {
                 return inLayer[t[0]] || inLayer[t[1]] || inLayer[t[2]];
               });
  return model;
}

FatPressure::FatPressure(const FatPressureModel& model, std::size_t storage)
    : model_(&model), area_(storage), force_(storage), pressures_(model.layers.size()) {}

double FatPressure::pressure(const FatPressureModel::Layer& layer, const StepCoefficients& step,
                             const PointSurroundings& around, double duration_s,
                             const VectorArray& position, const VectorArray& velocity) const {
  double volume_m3 = 0, rate_m3_per_s = 0, answer = 0;
  FASCIA_ASSERT(layer.volume_m3 > 0 && duration_s > 0 && step.step_s > 0, "a layer has a volume");
  for (std::size_t i = layer.first; i < std::size_t{layer.first} + layer.count; ++i) {
    const std::size_t k = model_->points[i];
    volume_m3 += double{heightOver(area_, around.anchor, position, k)};
    rate_m3_per_s += double{heightOver(area_, around.anchorVelocity, velocity, k)};
    answer += double{square(area_, k) * step.gain[k]};
  }
  // d²ΔV/dt² = p Σ N²/M', and the step's gain is h/M'.
  const double h2 = duration_s * duration_s,
               stiffness_Pa_per_m3 = model_->bulk_Pa / layer.volume_m3;
  const double alpha = h2 * stiffness_Pa_per_m3 * answer / double{step.step_s};
  const double firm = std::min(1.0, h2 * layer.tissueRate2_per_s2 / kFirmestTissue);
  const double end_m3 = volume_m3 - layer.rest_m3 + duration_s * rate_m3_per_s;
  const double p = -stiffness_Pa_per_m3 * end_m3 * (1 - firm) / (1 + alpha);
  return std::clamp(p, -model_->bulk_Pa, model_->bulk_Pa);
}

const VectorArray& FatPressure::press(const StepCoefficients& step, const PointSurroundings& around,
                                      double duration_s, const VectorArray& position,
                                      const VectorArray& velocity) {
  areaVectors(model_->triangles, position, area_);
  FASCIA_ASSERT(position.size() == area_.size() && velocity.size() == area_.size(),
                "the state is of this skin");
  for (std::size_t l = 0; l < model_->layers.size(); ++l) {
    const FatPressureModel::Layer& layer = model_->layers[l];
    pressures_[l] = pressure(layer, step, around, duration_s, position, velocity);
    const auto p = static_cast<float>(pressures_[l]);
    for (std::size_t i = layer.first; i < std::size_t{layer.first} + layer.count; ++i) {
      const std::size_t k = model_->points[i];
      force_.x[k] = p * area_.x[k], force_.y[k] = p * area_.y[k], force_.z[k] = p * area_.z[k];
    }
  }
  return force_;
}

}  // namespace fascia
