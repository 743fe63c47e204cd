#include <fascia/track/blend_source.h>

#include <algorithm>
#include <cassert>

#include <fascia/math/rotation_vector.h>

namespace fascia {
namespace {

// Part of the way from one rotation to another, the shorter way: exp(w φ) A with φ = log(B Aᵀ).
// Its angular velocity follows from φ̇ = J⁻¹(φ) (ω_B − exp(φ) ω_A).
JointRotation between(const JointRotation& a, const JointRotation& b, const Share& share) {
  const Quat step = b.rotation * a.rotation.conjugate();
  const Vec3 phi = vectorOf(step);
  const Vec3 phiRate = vectorRateOf(phi, b.angular_rad_per_s - step * a.angular_rad_per_s);
  const Quat part = rotationOf(share.weight * phi);
  const Vec3 partSpin =
      angularVelocityOf(share.weight * phi, share.rate_per_s * phi + share.weight * phiRate);
  return {a.joint, (part * a.rotation).normalized(), partSpin + part * a.angular_rad_per_s};
}

Share times(const Share& weight, double share) {
  return {weight.weight * share, weight.rate_per_s * share};
}

// Two of one parameter, or one against none, as one: by the weights that they have in the end.
Flesh::ParameterOverride mixed(const Flesh::ParameterOverride* lower,
                               const Flesh::ParameterOverride* upper, const Share& share) {
  Flesh::ParameterOverride out = lower ? *lower : *upper;
  double sum = 0, sumRate = 0, valueSum = 0, valueSumRate = 0;
  const auto add = [&](const Flesh::ParameterOverride* o, double w, double rate) {
    if (!o) return;
    const double weight = w * o->weight;
    const double weightRate = rate * o->weight + w * o->weightRate_per_s;
    sum += weight, sumRate += weightRate;
    valueSum += weight * o->value;
    valueSumRate += weightRate * o->value + weight * o->rate;
  };
  add(lower, 1 - share.weight, -share.rate_per_s);
  add(upper, share.weight, share.rate_per_s);
  out.weight = sum, out.weightRate_per_s = sumRate;
  if (sum <= 0) return out;
  out.value = valueSum / sum;
  out.rate = (valueSumRate - sumRate * out.value) / sum;
  return out;
}

}  // namespace

BlendSource::BlendSource(const Figure& figure)
    : figure_(figure), balls_(figure.skeleton), rest_(figure.skeleton.restPosture()) {}

std::size_t BlendSource::add(const PostureSource& source, const Fade& weight,
                             std::vector<double> joint_share, std::vector<double> morph_share) {
  assert(joint_share.empty() || joint_share.size() == figure_.skeleton.jointCount());
  assert(morph_share.empty() || morph_share.size() == figure_.morphs.size());
  if (morph_share.empty() && !joint_share.empty()) morph_share.assign(figure_.morphs.size(), 0.0);
  layers_.push_back({&source, weight, std::move(joint_share), std::move(morph_share)});
  return layers_.size() - 1;
}

void BlendSource::fade(std::size_t layer, double weight, double start_s, double duration_s) {
  Fade& fade = layers_[layer].weight;
  fade = {fade.at(start_s).weight, weight, start_s, duration_s};
}

void BlendSource::sample(double time_s, PostureSample& out) const {
  out.posture.values = rest_.values;
  out.posture.rates = rest_.rates;
  out.posture.rotations.clear();
  out.parameters.clear();
  figure_.morphs.rest(out.morphs);
  for (const Layer& layer : layers_) {
    const Share weight = layer.weight.at(time_s);
    if (weight.weight == 0 && weight.rate_per_s == 0) continue;
    if (weight.weight == 1 && weight.rate_per_s == 0 && layer.share.empty() &&
        layer.morphShare.empty()) {
      sampleFit(*layer.source, figure_, time_s, out);
      continue;
    }
    sampleFit(*layer.source, figure_, time_s, upper_);
    mix(layer, weight, out);
  }
}

void BlendSource::mix(const Layer& layer, const Share& weight, PostureSample& out) const {
  mixRotations(layer, weight, out.posture);
  mixValues(layer, weight, out.posture);
  mixParameters(layer, weight, out);
  mixMorphs(layer, weight, upper_.morphs, out.morphs);
}

// Straight; a morph of which both layers say the same keeps its bits.
void BlendSource::mixMorphs(const Layer& layer, const Share& weight, const MorphPose& upper,
                            MorphPose& out) {
  for (std::size_t i = 0; i < out.weights.size(); ++i) {
    const Share w = times(weight, layer.morphShare.empty() ? 1 : layer.morphShare[i]);
    const double way = upper.weights[i] - out.weights[i];
    out.rates[i] += w.weight * (upper.rates[i] - out.rates[i]) + w.rate_per_s * way;
    out.weights[i] += w.weight * way;
  }
}

// Of all ball joints, and before their angles are mixed.
void BlendSource::mixRotations(const Layer& layer, const Share& weight, Posture& out) const {
  balls_.read(out, lowerTurns_);
  balls_.read(upper_.posture, upperTurns_);
  out.rotations.resize(balls_.size());
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    const double share = layer.share.empty() ? 1 : layer.share[balls_.joint(i).index()];
    out.rotations[i] = between(lowerTurns_[i], upperTurns_[i], times(weight, share));
  }
}

void BlendSource::mixValues(const Layer& layer, const Share& weight, Posture& out) const {
  for (std::size_t v = 0; v < out.values.size(); ++v) {
    if (balls_.contains(v)) continue;
    const JointId joint = figure_.skeleton.valueJoint(static_cast<int>(v));
    const Share w = times(weight, layer.share.empty() ? 1 : layer.share[joint.index()]);
    const double way = upper_.posture.values[v] - out.values[v];
    out.rates[v] += w.weight * (upper_.posture.rates[v] - out.rates[v]) + w.rate_per_s * way;
    out.values[v] += w.weight * way;
  }
}

void BlendSource::mixParameters(const Layer& layer, const Share& weight, PostureSample& out) const {
  const auto shareOf = [&](const Flesh::ParameterOverride& o) {
    return times(weight,
                 layer.share.empty() ? 1 : layer.share[figure_.flesh.joint(o.solid).index()]);
  };
  const auto same = [](const Flesh::ParameterOverride& a) {
    return [&a](const Flesh::ParameterOverride& b) {
      return a.solid == b.solid && a.parameter == b.parameter;
    };
  };
  for (Flesh::ParameterOverride& lower : out.parameters) {
    const auto upper = std::ranges::find_if(upper_.parameters, same(lower));
    const bool both = upper != upper_.parameters.end();
    lower = mixed(&lower, both ? &*upper : nullptr, shareOf(lower));
  }
  for (const Flesh::ParameterOverride& upper : upper_.parameters)
    if (std::ranges::none_of(out.parameters, same(upper)))
      out.parameters.push_back(mixed(nullptr, &upper, shareOf(upper)));
}

std::vector<double> shareBelow(const Skeleton& skeleton, JointId root) {
  std::vector<double> share(skeleton.jointCount(), 0.0);
  for (std::size_t j = 0; j < share.size(); ++j) {
    const JointId id(j), parent = skeleton.parent(id);
    if (id == root || (parent.valid() && share[parent.index()] > 0)) share[j] = 1;
  }
  return share;
}

}  // namespace fascia
