#include <fascia/pose/jiggle.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <unordered_map>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/pose/softness.h>

namespace fascia {
namespace {

constexpr float kSpacing = 0.9f;    // of nodes, in local radii
constexpr float kNodeReach = 2.2f;  // of a node's weight, in spacings
constexpr float kDamping = 0.2f;    // ζ: a shake has died away after about four swings
constexpr float kLimit = 0.3f;      // largest offset at full dial, in local radii
constexpr float kLeastSoft = 0.05f;
constexpr float kLeastShare = 0.005f;  // of a node in a point: less is not seen, but costs time
constexpr std::size_t kJigglesPerTask = 512;
// A limb of 3 % of a figure of 1.7 m swings 7 times a second; thicker ones and larger figures
// slower, as √(1 / length).
constexpr float kFrequency_Hz = 7, kAtRadius = 0.03f, kAtSize_m = 1.7f;

float frequency_Hz(float radius_m, float size_m, float dial) {
  FASCIA_ASSERT(size_m > 0 && dial > 0, "only what jiggles has a frequency");
  const float thickness = std::sqrt(kAtRadius * size_m / std::max(radius_m, 0.01f * size_m));
  const float figure = std::sqrt(std::max(0.3f, size_m / kAtSize_m));
  return kFrequency_Hz * thickness / figure / std::sqrt(2 * dial);  // the dial is a compliance
}

// Points within `most` of a point along the edges, with their distances.
std::vector<std::pair<float, std::uint32_t>> pointsWithin(const PoseMesh& mesh, std::uint32_t from,
                                                          float most) {
  using Entry = std::pair<float, std::uint32_t>;
  std::vector<Entry> found;
  std::unordered_map<std::uint32_t, float> way{{from, 0.f}};
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  queue.push({0.f, from});
  while (!queue.empty()) {
    const auto [so, i] = queue.top();
    queue.pop();
    if (so > way[i]) continue;
    found.push_back({so, i});
    for (const PoseMesh::Edge& e : mesh.around(i)) {
      const float further = so + (mesh.rest[i] - mesh.rest[e.to]).norm();
      if (further >= most) continue;
      const auto known = way.find(e.to);
      if (known != way.end() && known->second <= further) continue;
      way[e.to] = further;
      queue.push({further, e.to});
    }
  }
  return found;
}

}  // namespace

Jiggle::Jiggle(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
               std::span<const float> dial) {
  FASCIA_ASSERT(dial.size() == mesh.size() && source.weights.size() == mesh.size(),
                "a dial for each point");
  if (std::all_of(dial.begin(), dial.end(), [](float d) { return d <= 0; })) return;
  const std::vector<float> softness = softnessOf(source, mesh, parts);
  std::vector<std::vector<Share>> shares(mesh.size());
  placeNodes(mesh, parts, softness, dial, shares);
  firstShare_.push_back(0);
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    if (softness[i] <= 1e-3f || dial[i] <= 0 || shares[i].empty()) continue;
    float sum = 0;
    for (const Share& s : shares[i]) sum += s.weight;
    const float scale = softness[i] / std::max(sum, 0.3f);
    for (const Share& s : shares[i])
      if (s.weight > kLeastShare * sum) shares_.push_back({s.node, scale * s.weight});
    points_.push_back(i);
    firstShare_.push_back(static_cast<std::uint32_t>(shares_.size()));
  }
}

// Softest and thickest flesh first; each node takes what lies within its spacing.
void Jiggle::placeNodes(const PoseMesh& mesh, const LimbParts& parts,
                        std::span<const float> softness, std::span<const float> dial,
                        std::vector<std::vector<Share>>& shares) {
  FASCIA_ASSERT(softness.size() == mesh.size() && shares.size() == mesh.size(),
                "a softness for each point");
  std::vector<std::uint32_t> order(mesh.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return softness[a] * parts.radius_m[a] > softness[b] * parts.radius_m[b];
  });
  std::vector<char> covered(mesh.size(), 0);
  for (const std::uint32_t i : order) {
    if (covered[i] || softness[i] < kLeastSoft || dial[i] <= 0) continue;
    const float spacing = kSpacing * parts.radius_m[i], reach = kNodeReach * spacing;
    const auto node = static_cast<std::uint32_t>(nodes_.size());
    for (const auto& [way, k] : pointsWithin(mesh, i, reach)) {
      if (way < spacing) covered[k] = 1;
      const float t = way / reach, near = 1 - t * t;
      shares[k].push_back({node, near * near});
    }
    nodes_.push_back(
        {i, static_cast<float>(2 * kPi) * frequency_Hz(parts.radius_m[i], mesh.size_m, dial[i]),
         kLimit * dial[i] * parts.radius_m[i]});
  }
}

JiggleState Jiggle::carryOver(const JiggleState& state, const Jiggle& before,
                              std::span<const Eigen::Vector3f> rest,
                              std::span<const Eigen::Vector3f> restBefore) const {
  JiggleState out;
  if (state.offset.size() != before.nodes_.size() || before.nodes_.empty()) return out;
  out.origin_m = state.origin_m;
  for (FrameArray* a : {&out.place, &out.placeVelocity}) a->assign(nodes_.size(), Vector4f::Zero());
  for (const Node& node : nodes_) {
    const auto away = [&](const Node& old) {
      return (restBefore[old.point] - rest[node.point]).squaredNorm();
    };
    const auto nearest = std::ranges::min_element(before.nodes_, {}, away);
    const auto k = static_cast<std::size_t>(nearest - before.nodes_.begin());
    out.offset.push_back(state.offset[k]);
    out.velocity.push_back(state.velocity[k]);
  }
  return out;
}

void Jiggle::step(double dt_s, std::span<const Vector4f> position, const Vec3& origin_m,
                  JiggleState& state) const {
  if (state.offset.size() != nodes_.size()) {
    state = {};
    for (FrameArray* a : {&state.offset, &state.velocity, &state.place, &state.placeVelocity})
      a->assign(nodes_.size(), Vector4f::Zero());
  }
  const auto h = static_cast<float>(dt_s);
  FASCIA_ASSERT(h > 0, "time goes on");
  FASCIA_ASSERT(state.velocity.size() == nodes_.size() && state.place.size() == nodes_.size(),
                "the state is of these nodes");
  const Vector4f moved = wide((origin_m - state.origin_m).cast<float>());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Vector4f& at = position[nodes_[k].point];
    const Vector4f speed =
        state.frames > 0 ? Vector4f((at - state.place[k] + moved) / h) : Vector4f::Zero();
    const Vector4f acceleration =
        state.frames > 1 ? Vector4f((speed - state.placeVelocity[k]) / h) : Vector4f::Zero();
    state.place[k] = at;
    state.placeVelocity[k] = speed;
    // The exact solution over h for a constant acceleration.
    const float w = nodes_[k].omega, swing = w * std::sqrt(1 - kDamping * kDamping);
    const float decay = std::exp(-kDamping * w * h), c = std::cos(swing * h),
                s = std::sin(swing * h);
    const Vector4f rest = -acceleration / (w * w);
    const Vector4f from = state.offset[k] - rest;
    const Vector4f rate = (state.velocity[k] + kDamping * w * from) / swing;
    const Vector4f now = decay * (c * from + s * rate);
    state.velocity[k] = -kDamping * w * now + decay * swing * (c * rate - s * from);
    state.offset[k] = rest + now;
  }
  state.origin_m = origin_m;
  state.frames = std::min(2, state.frames + 1);
}

void Jiggle::add(const JiggleState& state, FrameArray& shown, std::span<Vector4f> position) const {
  if (state.offset.size() != nodes_.size()) return;
  shown.resize(nodes_.size());
  FASCIA_ASSERT(points_.size() + 1 == firstShare_.size() || points_.empty(),
                "every point has its shares");
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const float length = state.offset[k].norm(), limit = nodes_[k].limit_m;
    const float cut = length > 0 ? limit * std::tanh(length / limit) / length : 0;
    shown[k] = cut * state.offset[k];
  }
  parallelFor((points_.size() + kJigglesPerTask - 1) / kJigglesPerTask, [&](std::size_t chunk) {
    const std::size_t end = std::min(points_.size(), kJigglesPerTask * (chunk + 1));
    for (std::size_t p = kJigglesPerTask * chunk; p < end; ++p) {
      Vector4f sum = Vector4f::Zero();
      for (std::uint32_t q = firstShare_[p]; q < firstShare_[p + 1]; ++q)
        sum += shares_[q].weight * shown[shares_[q].node];
      position[points_[p]] += sum;
    }
  });
}

}  // namespace fascia
