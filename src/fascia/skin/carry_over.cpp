#include <fascia/skin/carry_over.h>

#include <memory>
#include <utility>

#include <fascia/math/points.h>
#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/grid/grid_wrap.h>
#include <fascia/skin/grid/resample.h>

namespace fascia {
namespace {

// An edit that moves flesh farther than this share of the skin's size takes the skin along. Within
// it the skin stays where it is and is pulled and pushed over; farther, solids would be moved
// through it, and it would be held on their wrong side.
constexpr double kLargestEdit = 0.05;

bool sameLayout(const GridLayout& a, const GridLayout& b) {
  return a.columns == b.columns && a.rows == b.rows;
}

bool samePlaces(const VectorArray& a, const VectorArray& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

// Whether an entry of per-point arrays means the same point in both.
bool samePoints(const Skin& a, const Skin& b) {
  if (a.grid() && b.grid()) return sameLayout(a.grid()->layout(), b.grid()->layout());
  return !a.grid() && !b.grid() && a.isSimulated() == b.isSimulated() &&
         a.fixedPoints().size() == b.fixedPoints().size() &&
         (a.parts().shape == b.parts().shape || samePlaces(a.restPosition(), b.restPosition()));
}

// From one grid to another: what each point of it does.
SkinState onOtherGrid(const Skin& from, const SkinState& state, const Skin& to) {
  SkinState out = resampled(from, state, to);
  out.joints = state.joints;
  out.starting = state.starting;
  out.surroundings.resize(to.topology().storage());
  if (!state.ready) return out;
  out.surroundings.anchorVelocity =
      resample(from.grid()->layout(), state.surroundings.anchorVelocity, to.grid()->layout());
  out.ready = true;
  return out;
}

// Whether every point hangs on the same flesh in both, so that its strand moves only with that. A
// grid that was wrapped anew is also tied anew, which is no reason to move it.
bool sameStrands(const Skin& a, const Skin& b) {
  return !a.grid() || a.parts().gridRest->wrap == b.parts().gridRest->wrap;
}

template <class Visit>
void forEachStrand(const Skin& skin, const Visit& visit) {
  if (skin.grid()) {
    for (const TissueAnchors::Anchor& a : skin.grid()->anchors().anchors()) visit(a.point);
    return;
  }
  for (std::size_t k = 0; k < skin.pointCount(); ++k) visit(k);
}

// If the edit has put flesh somewhere else, skin goes along with what it is tied to.
void goAlong(const Skin& skin, const SkinPose& pose, const VectorArray& anchorBefore,
             PointPlacer& placer, SkinState& state) {
  const VectorArray& anchor = state.surroundings.anchor;
  const double most_m = kLargestEdit * skin.size_m();
  bool far = false;
  forEachStrand(skin, [&](std::size_t k) {
    far = far || (pointAt(anchor, k) - pointAt(anchorBefore, k)).squaredNorm() > most_m * most_m;
  });
  if (!far) return;
  forEachStrand(skin, [&](std::size_t k) {
    for (const auto axis : VectorArray::kAxes)
      (state.position.*axis)[k] += (anchor.*axis)[k] - (anchorBefore.*axis)[k];
  });
  placer.placeFixed(pose, state.position);
  skin.topology().complete(state.position);
  state.surroundings.normal.fill(0.f);
}

SkinState placedAnew(const Skin& skin, const SkinPose& pose) {
  SkinState out;
  placeSkin(skin, pose, out);
  out.starting = true;
  return out;
}

}  // namespace

SkinState carryOver(const Skin& from, SkinState state, const Skin& to, const SkinPose& pose) {
  if (from.id() == to.id()) return state;
  const bool same = samePoints(from, to);
  if (!same && !(from.grid() && to.grid())) return placedAnew(to, pose);
  SkinState coarser;  // of the grid that a fine one rides on
  const bool rode = from.coarse() && !state.coarse.empty();
  if (state.ready && to.coarse())
    coarser = rode ? carryOver(*from.coarse(), std::move(state.coarse.front()), *to.coarse(), pose)
                   : carryOver(from, state, *to.coarse(), pose);
  SkinState out = same ? std::move(state) : onOtherGrid(from, state, to);
  // The edit is no motion: neither joints nor anchors have a velocity from it.
  if (!out.joints.empty()) out.joints.assign(pose.joints.begin(), pose.joints.end());
  if (from.rigged() != to.rigged()) out.jiggle.frames = 0;
  out.coarse.clear();
  if (!out.ready) return out;
  const std::unique_ptr<PointPlacer> placer = to.attachment().makePlacer();
  const VectorArray anchorBefore = out.surroundings.anchor;
  placer->placeAnchors(pose, out.surroundings.anchor);
  if (same && sameStrands(from, to)) goAlong(to, pose, anchorBefore, *placer, out);
  if (!to.coarse()) return out;
  out.coarse.push_back(std::move(coarser));
  // A fine point goes with the coarse surface beneath it already.
  if (!rode || out.coarseVelocity.size() != out.velocity.size()) out.coarseVelocity = out.velocity;
  return out;
}

const char* misfit(const Skin& skin, const SkinState& state) {
  const std::size_t storage = skin.topology().storage();
  if (state.position.size() != storage) return "positions";
  if (!skin.isSimulated() || !state.ready) return nullptr;
  if (state.velocity.size() != storage) return "velocities";
  if (state.surroundings.anchor.size() != storage || state.surroundings.offset.size() != storage)
    return "surroundings";
  const bool rides = skin.coarse() && skin.settings().integrator == "auto";
  if (!rides) return nullptr;
  if (state.coarse.size() != 1 || state.coarseVelocity.size() != storage) return "coarse grid";
  return misfit(*skin.coarse(), state.coarse.front());
}

}  // namespace fascia
