#include <fascia/skin/skin_stepper.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/math/points.h>
#include <fascia/skin/cloth/cloth_stepper.h>
#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/ode_skin.h>
#include <fascia/skin/posed_skin_run.h>

namespace fascia {
namespace {

// The farthest that a joint may turn within one interval. Within an interval a point sees the flesh
// as a plane, so that skin on a limb of radius r that turns by this angle ends up r kTurn_rad²/8
// too far out. A smaller angle makes more intervals, and every interval tests all contacts anew.
constexpr double kTurn_rad = 0.12;
constexpr int kMostIntervals = 8;
// The step of a fine grid whose large motions are computed on a coarse one. It only has to relax
// what the coarse grid cannot show. Longer steps leave folds behind in fast motion; the cost is in
// proportion to the number of steps.
constexpr double kRidingStep_s = 1.0 / 960;
// If an anchor goes farther than this share of the skin's size within one interval, the body has
// been put somewhere else, and the skin goes there with it instead of being pulled.
constexpr double kAnchorJump = 0.2;
// Skin may come this much nearer to other skin within an interval than its velocity says; a share
// of the skin's size. Contacts within this reach are looked for.
constexpr float kSelfReach = 0.002f;
// The farthest that flesh contacts are looked for where points may only slide so far from their
// anchors; a share of the skin's size.
constexpr float kSlidingReach = 0.02f;
// How often stretched skin is shortened and taken out of the flesh again in one interval, at most.
constexpr int kStretchRounds = 8;
constexpr float kStretchedBeyond = 0.1f;  // as long as an edge is longer than it may be by so much
// Where more than this share of all edges is still twice as long as may be, nothing has helped.
// (Where fewer are, something is squeezed for a moment, and comes free.)
constexpr float kTorn = 1;
constexpr double kMostTorn = 0.005;
// Stretched skin is also shortened within an interval, after so many steps: very stiff skin has
// pulled far by then.
constexpr int kStepsBetweenLimits = 32;
// How far skin may fall within an interval, as a share of its size: at usual gravity it does not.
constexpr double kFall = 0.02;
// Fastest speed relative to the flesh that a state may hold, in skin sizes per second.
constexpr double kFastest_per_s = 60;

using Clock = std::chrono::steady_clock;

class Stopwatch {
 public:
  // Books the time since the last call to `account`.
  void lap(double& account) {
    const Clock::time_point now = Clock::now();
    account += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  Clock::time_point last_ = Clock::now();
};

// A point that is not where or as fast as a point can be is lost.
bool isLost(const VectorArray& r, const VectorArray& v, std::size_t k) {
  constexpr float kFar = 1e18f;  // squared
  return !(floatPointAt(r, k).squaredNorm() < kFar && floatPointAt(v, k).squaredNorm() < kFar);
}

void slowDown(VectorArray& velocity, const VectorArray& anchorVelocity, float fastest,
              std::size_t k) {
  const Eigen::Vector3f flesh = floatPointAt(anchorVelocity, k),
                        relative = floatPointAt(velocity, k) - flesh;
  const float speed = relative.norm();
  if (speed > fastest)
    setPoint(velocity, k, Vec3((flesh + fastest / speed * relative).cast<double>()));
}

std::unique_ptr<SurfaceStepper> makeSurface(const Skin& skin) {
  if (!skin.isCloth()) return skin.topology().makeStepper();
  return std::make_unique<ClothStepper>(*skin.grid()->topology, skin.restPosition(), skin.points(),
                                        skin.quantities()[SkinQuantity::bending]);
}

}  // namespace

SkinStepper::SkinStepper(const Skin& skin)
    : skin_(skin),
      placer_(skin.attachment().makePlacer()),
      surface_(makeSurface(skin)),
      stretchLimit_(skin.topology().makeStretchLimit()),
      contact_(skin.makeContact()) {
  for (VectorArray* a : {&nextAnchor_, &target_}) a->resize(skin.topology().storage());
  if (skin.selfContact()) selfContact_ = SelfContact(*skin.selfContact());
  if (skin.fatPressure()) {
    fatPressure_ = FatPressure(*skin.fatPressure(), skin.topology().storage());
    for (VectorArray* a : {&carried_, &nextCarried_}) a->resize(skin.topology().storage());
  }
  const std::string& integrator = skin.settings().integrator;
  if (integrator != "auto" && integrator != "leapfrog" && !skin.isCloth())
    ode_ = std::make_unique<OdeSkin>(skin);
  if (integrator == "auto" && skin.coarse()) {
    coarse_ = std::make_unique<SkinStepper>(*skin.coarse());
    prolongation_ = Prolongation(skin.coarse()->grid()->layout(), skin.grid()->layout());
  }
}

SkinStepper::~SkinStepper() = default;

void SkinStepper::advance(SkinPoseSource& poses, double start_s, double end_s, SkinState& state,
                          SkinStats& stats) {
  if (!state.ready) begin(poses.at(start_s), state);
  FASCIA_ASSERT(state.velocity.size() == skin_.topology().storage(), "begin() filled the state");
  const double span = end_s - start_s;
  FASCIA_ASSERT(span > 0, "time goes on");
  FASCIA_ASSERT(state.position.size() == skin_.topology().storage(), "the state is of this skin");
  // Anew, so that copies of a state, which have no scratch memory, have the same bits.
  if (skin_.fatPressure()) placer_->placeAll(poses.at(start_s), carried_);
  const SkinPose end = poses.at(end_s);
  const int intervals = intervalCount(end, span, state);
  for (int i = 0; i < intervals; ++i) {
    const double from = start_s + span * i / intervals, to = start_s + span * (i + 1) / intervals;
    if (ode_)
      odeInterval(poses, from, to, state, stats);
    else
      interval(intervals == 1 ? end : poses.at(to), to - from, state, stats);
  }
  state.joints.assign(end.joints.begin(), end.joints.end());
}

// Enough that no joint turns farther than kTurn_rad in one.
int SkinStepper::intervalCount(const SkinPose& end, double span_s, const SkinState& state) const {
  double leastCosine = 1;
  for (std::size_t j = 0; j < end.joints.size() && j < state.joints.size(); ++j) {
    // trace(Rᵀ R') = 1 + 2 cos(angle between)
    const double trace = state.joints[j].rotation.cwiseProduct(end.joints[j].rotation).sum();
    leastCosine = std::min(leastCosine, 0.5 * (trace - 1));
  }
  const double turn = std::acos(std::clamp(leastCosine, -1.0, 1.0));
  const int forTurn = static_cast<int>(std::ceil(std::min(turn / kTurn_rad, 1.0 * kMostIntervals)));
  const double longest_s = std::min(skin_.settings().interval_s, fallTime());
  const int forTime = static_cast<int>(std::ceil(span_s / longest_s - 1e-6));
  return std::max({1, forTurn, forTime});
}

// In which skin at rest falls as far as may be between two contact tests.
double SkinStepper::fallTime() const {
  const double gravity = skin_.settings().gravity_m_per_s2.norm();
  return std::sqrt(2 * kFall * skin_.size_m() / std::max(gravity, 1e-6));
}

// Anchors and half spaces for a state that comes from somewhere else.
void SkinStepper::begin(const SkinPose& pose, SkinState& state) {
  const std::size_t storage = skin_.topology().storage();
  state.velocity.resize(storage);
  state.surroundings.resize(storage);
  placer_->placeAnchors(pose, state.surroundings.anchor);
  SkinStats ignored;
  settle(pose, skin_.settings().interval_s, state, ignored);
  // What starts takes over the whole of its anchors' velocity; so does the flesh beside them.
  if (state.starting) {
    state.velocity.fill(0.f);
    state.surroundings.fleshVelocity.fill(0.f);
  }
  if (coarse_) {
    state.coarse.assign(1, resampled(skin_, state, coarse_->skin()));
    coarse_->begin(pose, state.coarse.front());
    state.coarseVelocity.resize(storage);
    state.coarseVelocity.fill(0.f);
  }
  state.ready = true;
}

void SkinStepper::interval(const SkinPose& pose, double duration_s, SkinState& state,
                           SkinStats& stats) {
  const int steps = chooseStep(duration_s);
  FASCIA_ASSERT(duration_s > 0 && state.velocity.size() == state.position.size(),
                "an interval lasts");
  if (coarse_) rideOnCoarse(pose, duration_s, state, stats);
  Stopwatch watch;
  surround(pose, duration_s, state, stats);
  watch.lap(stats.other_s);
  leapfrog(steps, duration_s, state, stats);
  watch.lap(stats.forces_s);
  settle(pose, duration_s, state, stats);
  watch.lap(stats.constraints_s);
}

void SkinStepper::odeInterval(SkinPoseSource& poses, double start_s, double end_s, SkinState& state,
                              SkinStats& stats) {
  Stopwatch watch;
  surround(poses.at(end_s), end_s - start_s, state, stats);
  watch.lap(stats.other_s);
  ode_->advance(poses, start_s, end_s, *contact_, state, stats);
  watch = Stopwatch();  // the solver books its own time
  settle(poses.at(end_s), end_s - start_s, state, stats);
  watch.lap(stats.constraints_s);
}

// Steps the coarse grid first and hands its velocity to the points that ride on it.
void SkinStepper::rideOnCoarse(const SkinPose& pose, double duration_s, SkinState& state,
                               SkinStats& stats) {
  SkinState& coarse = state.coarse.front();
  coarseStart_ = coarse.position;
  coarse.starting = state.starting;
  const std::uint64_t stepsBefore = stats.steps;
  coarse_->interval(pose, duration_s, coarse, stats);
  stats.steps = stepsBefore;  // the fine grid's are counted

  Stopwatch watch;
  coarseGridVelocity_.resize(coarseStart_.size());
  FASCIA_ASSERT(coarse.position.size() == coarseStart_.size(), "the coarse grid keeps its points");
  const auto rate = static_cast<float>(1 / duration_s);
  for (const auto axis : VectorArray::kAxes)
    for (std::size_t k = 0; k < coarseStart_.size(); ++k)
      (coarseGridVelocity_.*axis)[k] =
          ((coarse.position.*axis)[k] - (coarseStart_.*axis)[k]) * rate;
  prolongation_.apply(coarseGridVelocity_, coarseNext_);
  followCoarse(coarseNext_, carryShare(state), state.coarseVelocity, state.velocity);
  watch.lap(stats.other_s);
}

// The share of its anchor's changes of velocity that each point takes over.
const FloatArray& SkinStepper::carryShare(const SkinState& state) {
  if (!state.starting) return coefficients_.carry;
  wholly_.assign(skin_.topology().storage(), 1.f);
  return wholly_;
}

// Where anchors and fixed points go during the interval.
void SkinStepper::surround(const SkinPose& pose, double duration_s, SkinState& state,
                           SkinStats& stats) {
  PointSurroundings& around = state.surroundings;
  placer_->placeAnchors(pose, nextAnchor_);
  if (skin_.fatPressure()) placer_->placeCarried(pose, nextCarried_);
  const auto rate = static_cast<float>(1 / duration_s);
  // Equations of motion carry by themselves; what rides has been carried.
  const bool carries = ode_ ? state.starting : !coarse_;
  const float way = followAnchors(nextAnchor_, rate, carries ? &carryShare(state) : nullptr, around,
                                  state.velocity);
  state.starting = false;
  const auto jump = static_cast<float>(kAnchorJump * skin_.size_m());
  if (!(way < jump * jump)) {
    // A posture jump: the skin jumps with the flesh.
    startAnew(pose, state, stats);
    around.anchor = nextAnchor_;
    carried_ = nextCarried_;
  }
  placer_->placeFixed(pose, target_);
  for (const std::size_t k : skin_.fixedPoints())
    for (const auto axis : VectorArray::kAxes)
      (state.velocity.*axis)[k] = ((target_.*axis)[k] - (state.position.*axis)[k]) * rate;
}

// At rest, from where the flesh carries it.
void SkinStepper::startAnew(const SkinPose& pose, SkinState& state, SkinStats& stats) const {
  placeSkin(skin_, pose, state);
  state.surroundings.anchorVelocity.fill(0.f);
  state.surroundings.normal.fill(0.f);
  state.coarseVelocity.fill(0.f);
  stats.repaired_points += skin_.pointCount();
}

// The number of equal steps for an interval; readies the coefficients for their length.
int SkinStepper::chooseStep(double duration_s) {
  const double given = skin_.settings().step_s;
  const double longest = given > 0 ? given : coarse_ ? kRidingStep_s : skin_.defaultStep_s();
  FASCIA_ASSERT(longest > 0, "a step lasts");
  const int steps = std::max(1, static_cast<int>(std::ceil(duration_s / longest - 1e-6)));
  const double h = duration_s / steps;
  // Frame times are rounded sums: only a real change of step is worth new coefficients.
  if (std::abs(h - coefficients_.step_s) > 1e-6 * h)
    prepareStep(skin_.points(), skin_.contactResponse(), h, coefficients_,
                skin_.isCloth() ? AddedMass::none : AddedMass::asNeeded);
  return steps;
}

void SkinStepper::leapfrog(int steps, double duration_s, SkinState& state, SkinStats& stats) {
  StepInputs inputs{&skin_.points(), &coefficients_, &state.surroundings, nullptr, {}};
  for (int a = 0; a < 3; ++a)
    inputs.gravity[a] = static_cast<float>(skin_.settings().gravity_m_per_s2[a]);
  if (skin_.fatPressure()) {
    fatPressure_.begin(coefficients_,
                       {carried_, nextCarried_, state.surroundings.anchor, nextAnchor_, duration_s},
                       state.position);
    inputs.extraForce = &fatPressure_.force();
    inputs.stepEnd = &fatPressure_;
  }
  for (int done = 0; done < steps; done += kStepsBetweenLimits) {
    if (done > 0 && stretchLimit_.exceeded(state.position, kStretchedBeyond)) {
      stretchLimit_.apply(skin_.points(), state.position, state.velocity);
      skin_.topology().complete(state.position);
    }
    surface_->run(inputs, done, std::min(kStepsBetweenLimits, steps - done), state.position,
                  state.velocity);
  }
  std::swap(carried_, nextCarried_);
  const double h = coefficients_.step_s;
  stats.steps += static_cast<std::uint64_t>(steps);
  stats.step_min_s = std::min(stats.step_min_s, h);
  stats.step_max_s = std::max(stats.step_max_s, h);
}

// Ends an interval: fixed points to their exact places, exact non-penetration, half spaces and
// anchors for the next one.
void SkinStepper::settle(const SkinPose& pose, double duration_s, SkinState& state,
                         SkinStats& stats) {
  repair(pose, state, stats);
  if (state.ready) {
    takeFixed(state.position);
    std::swap(state.surroundings.anchor, nextAnchor_);
  } else {
    placer_->placeFixed(pose, state.position);
  }
  if (!skin_.points().slideLimit.empty()) limitSlide(state);
  skin_.topology().complete(state.position);
  // Skin against itself comes before the flesh, which has the last word.
  if (skin_.selfContact()) {
    if (!state.surroundings.fleshNormal.x.empty())
      selfContact_.flatten(skin_.points(), state.surroundings.fleshNormal, state.position,
                           state.velocity);
    selfContact_.separate(skin_.points(), kSelfReach * static_cast<float>(skin_.size_m()),
                          state.position, state.velocity, static_cast<float>(duration_s),
                          state.surroundings.fleshNormal);
  }
  stretchLimit_.apply(skin_.points(), state.position, state.velocity);
  // More than the way that the fastest point goes until the next test.
  const auto size = static_cast<float>(skin_.size_m());
  const float reach =
      std::min(1.5f * state.maxSpeed_m_per_s * static_cast<float>(duration_s) + 0.005f * size,
               skin_.points().slideLimit.empty() ? size : kSlidingReach * size);
  const auto leaveFlesh = [&] {
    const SkinContact::Result result = contact_->project(
        *pose.field, skin_.points(), reach, static_cast<float>(skin_.contactResponse().restitution),
        state.position, state.velocity, state.surroundings);
    state.maxSpeed_m_per_s = result.maxSpeed_m_per_s;
  };
  leaveFlesh();
  // What flesh pushes out pulls at what lies around it.
  for (int round = 0; round < kStretchRounds; ++round) {
    if (!stretchLimit_.exceeded(state.position, kStretchedBeyond)) break;
    stretchLimit_.apply(skin_.points(), state.position, state.velocity);
    leaveFlesh();
  }
  if (stretchLimit_.exceeded(state.position, kTorn) &&
      stretchLimit_.shareExceeding(state.position, kTorn) > kMostTorn) {
    startAnew(pose, state, stats);
    leaveFlesh();
  }
  if (skin_.selfContact()) {
    state.surroundings.fleshNormal = state.surroundings.normal;
    selfContact_.writeHalfSpaces(state.position, state.velocity, static_cast<float>(duration_s),
                                 state.surroundings);
  }
  skin_.topology().complete(state.position);
}

// Fixed points to where surround() has found that this interval's end carries them.
void SkinStepper::takeFixed(VectorArray& position) const {
  for (const std::size_t k : skin_.fixedPoints())
    for (const auto axis : VectorArray::kAxes) (position.*axis)[k] = (target_.*axis)[k];
}

// Tissue gives way only so far, however hard a body is shaken: points that are farther from their
// anchors come back to the limit and stop moving away.
void SkinStepper::limitSlide(SkinState& state) const {
  const FloatArray& limit = skin_.points().slideLimit;
  const VectorArray &anchor = state.surroundings.anchor,
                    &anchorVelocity = state.surroundings.anchorVelocity;
  VectorArray &r = state.position, &v = state.velocity;
  for (std::size_t k = 0; k < limit.size(); ++k) {
    const float dx = r.x[k] - anchor.x[k], dy = r.y[k] - anchor.y[k], dz = r.z[k] - anchor.z[k];
    const float squared = dx * dx + dy * dy + dz * dz;
    if (squared <= limit[k] * limit[k]) continue;
    const float scale = limit[k] / std::sqrt(squared);
    r.x[k] = anchor.x[k] + scale * dx;
    r.y[k] = anchor.y[k] + scale * dy;
    r.z[k] = anchor.z[k] + scale * dz;
    const float away = dx * (v.x[k] - anchorVelocity.x[k]) + dy * (v.y[k] - anchorVelocity.y[k]) +
                       dz * (v.z[k] - anchorVelocity.z[k]);
    if (away <= 0) continue;
    v.x[k] -= away / squared * dx;
    v.y[k] -= away / squared * dy;
    v.z[k] -= away / squared * dz;
  }
}

// No state leaves a step with a number that is not finite, whose point returns to where the flesh
// carries it, or with a speed that no body has, which is lowered.
void SkinStepper::repair(const SkinPose& pose, SkinState& state, SkinStats& stats) {
  const auto fastest = static_cast<float>(kFastest_per_s * skin_.size_m());
  const VectorArray& anchorVelocity = state.surroundings.anchorVelocity;
  const auto broken = [&](const SkinTopology::Range& r) {
    return anyBroken(state.position, state.velocity, anchorVelocity, fastest, r.first,
                     r.first + r.count);
  };
  const std::span<const SkinTopology::Range> ranges = skin_.topology().ranges();
  if (std::none_of(ranges.begin(), ranges.end(), broken)) return;
  std::vector<std::size_t> lost;
  for (const PointBlock& b : skin_.blocks()) {
    for (std::size_t k = b.first; k < b.first + b.count; ++k) {
      if (isLost(state.position, state.velocity, k))
        lost.push_back(k);
      else
        slowDown(state.velocity, anchorVelocity, fastest, k);
    }
  }
  if (lost.empty()) return;
  SkinState placed;
  placeSkin(skin_, pose, placed);
  for (const std::size_t k : lost) {
    for (const auto axis : VectorArray::kAxes) {
      (state.position.*axis)[k] = (placed.position.*axis)[k];
      (state.velocity.*axis)[k] = (anchorVelocity.*axis)[k];
    }
  }
  stats.repaired_points += lost.size();
}

SkinWorkspace::SkinWorkspace() = default;
SkinWorkspace::~SkinWorkspace() = default;
SkinWorkspace::SkinWorkspace(const SkinWorkspace&) {}
SkinWorkspace& SkinWorkspace::operator=(const SkinWorkspace&) {
  return *this;
}

SkinRun& SkinWorkspace::run(const Skin& skin) {
  if (run_ && run_->skin().id() == skin.id()) return *run_;
  if (skin.isSimulated())
    run_ = std::make_unique<SkinStepper>(skin);
  else
    run_ = std::make_unique<PosedSkinRun>(skin);
  return *run_;
}

void advanceSkin(const Skin& skin, SkinPoseSource& poses, double start_s, double end_s,
                 SkinState& state, SkinWorkspace& workspace, SkinStats& stats) {
  workspace.run(skin).advance(poses, start_s, end_s, state, stats);
}

}  // namespace fascia
