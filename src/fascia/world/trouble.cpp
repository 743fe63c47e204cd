#include <fascia/world/trouble.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace fascia {
namespace {

constexpr std::array kTroubleNames{"inside out", "crushed", "sunk", "inside", "restored", "let go"};

bool isDepth(BodyTrouble::Kind kind) {
  return kind == BodyTrouble::Kind::sunk || kind == BodyTrouble::Kind::inside;
}

std::string seconds(double time_s) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.3g s", time_s);
  return text.data();
}

std::string stateOf(const BodyTrouble& trouble) {
  std::array<char, 32> worst;
  std::snprintf(worst.data(), worst.size(), "%.2g", trouble.worst);
  switch (trouble.kind) {
    case BodyTrouble::Kind::insideOut:
      return "was inside out somewhere";
    case BodyTrouble::Kind::crushed:
      return "was crushed to " + std::string(worst.data()) + " of its volume";
    case BodyTrouble::Kind::sunk:
      return "was " + std::string(worst.data()) + " m below the ground";
    default:
      return "was " + std::string(worst.data()) + " m deep inside of " + trouble.with;
  }
}

}  // namespace

const char* nameOf(BodyTrouble::Kind kind) {
  return kTroubleNames[static_cast<std::size_t>(kind)];
}

std::string textOf(const Stage& stage, const BodyTrouble& trouble) {
  const std::string& name = stage.body(trouble.body).name;
  if (trouble.kind == BodyTrouble::Kind::letGo)
    return "at " + seconds(trouble.from_s) + " " + name +
           " was let go: to lead it on would have squeezed " +
           (trouble.with == name ? "it" : trouble.with) + " flat";
  if (trouble.kind == BodyTrouble::Kind::restored)
    return "at " + seconds(trouble.from_s) + " " + name +
           ", which had collapsed, started anew undeformed";
  const std::string from = trouble.from_s == trouble.to_s && !trouble.lasts
                               ? " at " + seconds(trouble.from_s)
                               : " from " + seconds(trouble.from_s);
  if (trouble.lasts) return name + " " + stateOf(trouble) + from + " to the end";
  if (trouble.from_s == trouble.to_s) return name + " " + stateOf(trouble) + from;
  return name + " " + stateOf(trouble) + from + " to " + seconds(trouble.to_s);
}

bool anyFault(std::span<const BodyTrouble> troubles) {
  return std::ranges::any_of(
      troubles, [](const BodyTrouble& t) { return t.kind != BodyTrouble::Kind::letGo; });
}

void TroubleLog::look(const Stage& stage, const OdeState& bodies, BodyContacts* contacts,
                      std::span<const std::string> obstacles) {
  const double time_s = bodies.t_s;
  for (std::size_t b = 0; b < stage.bodies().bodyCount(); ++b) {
    const BodyShape& shape = stage.bodies().shape(BodyId(b));
    const auto q = stage.bodies().part(BodyId(b), std::span<const double>(bodies.r));
    const double least = shape.leastGrowth(q), mean = shape.meanGrowth(q);
    if (!(least > 0)) note(BodyTrouble::Kind::insideOut, BodyId(b), {}, time_s, least);
    if (!(mean > BodyTrouble::kCrushed))
      note(BodyTrouble::Kind::crushed, BodyId(b), {}, time_s, mean);
  }
  overlaps_.clear();
  if (contacts) contacts->findOverlaps(bodies.r, BodyTrouble::kDepth, overlaps_);
  for (const BodyContacts::Overlap& overlap : overlaps_) {
    if (overlap.other.valid())
      note(BodyTrouble::Kind::inside, overlap.body, stage.body(overlap.other).name, time_s,
           overlap.depth_m);
    else if (overlap.obstacle.valid())
      note(BodyTrouble::Kind::inside, overlap.body, obstacles[overlap.obstacle.index()], time_s,
           overlap.depth_m);
    else
      note(BodyTrouble::Kind::sunk, overlap.body, {}, time_s, overlap.depth_m);
  }
  for (BodyTrouble& trouble : troubles_)
    trouble.lasts = trouble.to_s == time_s && trouble.kind < BodyTrouble::Kind::restored;
  last_s_ = time_s;
}

void TroubleLog::note(BodyTrouble::Kind kind, BodyId body, const std::string& with, double time_s,
                      double worst) {
  const auto same = [&](const BodyTrouble& t) {
    return (t.to_s == last_s_ || t.to_s == time_s) && t.kind == kind && t.body == body &&
           t.with == with;
  };
  const auto known = std::ranges::find_if(troubles_, same);
  if (known != troubles_.end()) {
    known->to_s = time_s;
    known->worst = isDepth(kind) ? std::max(known->worst, worst) : std::min(known->worst, worst);
  } else if (troubles_.size() < kMost) {
    troubles_.push_back({kind, body, with, time_s, time_s, worst});
  }
}

void TroubleLog::noteRestored(double time_s, BodyId body) {
  if (troubles_.size() < kMost)
    troubles_.push_back({BodyTrouble::Kind::restored, body, {}, time_s, time_s, 0});
}

void TroubleLog::noteLetGo(double time_s, BodyId body, const std::string& squeezed) {
  if (troubles_.size() < kMost)
    troubles_.push_back({BodyTrouble::Kind::letGo, body, squeezed, time_s, time_s, 0});
}

}  // namespace fascia
