#include <fascia/flesh/morphs.h>

#include <algorithm>
#include <cmath>

namespace fascia {

int Morphs::find(std::string_view name) const {
  const auto found = std::ranges::find(list_, name, &MorphDef::name);
  return found == list_.end() ? -1 : static_cast<int>(found - list_.begin());
}

void Morphs::rest(MorphPose& out) const {
  out.weights.clear();
  out.rates.clear();
  admit(out);
}

void Morphs::admit(MorphPose& pose) const {
  const std::size_t said = std::min(pose.weights.size(), size());
  pose.weights.resize(size());
  pose.rates.resize(said);
  pose.rates.resize(size());
  for (std::size_t i = 0; i < size(); ++i) {
    double &weight = pose.weights[i], &rate = pose.rates[i];
    if (i >= said || !std::isfinite(weight)) {
      weight = list_[i].rest;
      rate = 0;
      continue;
    }
    const double within = std::clamp(weight, -kMostMorphWeight, kMostMorphWeight);
    if (within != weight || !std::isfinite(rate)) rate = 0;
    weight = within;
  }
}

}  // namespace fascia
