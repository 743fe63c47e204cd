#include <fascia/flesh/posture_source.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

bool exists(const Flesh& flesh, const Flesh::ParameterOverride& o) {
  return o.solid.valid() && o.solid.index() < flesh.solidCount() && o.parameter >= 0 &&
         static_cast<std::size_t>(o.parameter) < flesh.restSolid(o.solid).parameterCount();
}

bool weighs(const Flesh::ParameterOverride& o) {
  return o.weight >= 0 && o.weight <= 1 && std::isfinite(o.weightRate_per_s);  // false for NaN
}

}  // namespace

void admit(const Figure& figure, const Posture& former, PostureSample& sample) {
  const Skeleton& skeleton = figure.skeleton;
  Posture& posture = sample.posture;
  const std::size_t count = skeleton.valueCount();
  for (std::size_t i = posture.values.size(); i < count; ++i)
    posture.values.push_back(skeleton.valueDof(static_cast<int>(i)).rest);
  posture.values.resize(count);
  posture.rates.resize(count);
  skeleton.resolveRotations(former.values, posture);
  skeleton.clampToLimits(posture);
  std::erase_if(sample.parameters, [&](const Flesh::ParameterOverride& o) {
    return !exists(figure.flesh, o) || !weighs(o);
  });
  figure.morphs.admit(sample.morphs);
}

void ask(const PostureSource& source, double time_s, PostureSample& out) {
  out.morphs.weights.clear();
  out.morphs.rates.clear();
  source.sample(time_s, out);
}

void sampleFit(const PostureSource& source, const Figure& figure, double time_s,
               PostureSample& out) {
  ask(source, time_s, out);
  admit(figure, {}, out);
}

}  // namespace fascia
