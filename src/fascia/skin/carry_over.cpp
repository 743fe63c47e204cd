#include <fascia/skin/carry_over.h>

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <utility>

#include <fascia/math/points.h>
#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/grid/grid_wrap.h>
#include <fascia/skin/grid/resample.h>
#include <fascia/skin/mesh/mesh_rest.h>
#include <fascia/skin/mesh/rigged_skin.h>

namespace fascia {
namespace {

// An edit that moves flesh farther than this share of the skin's size takes the skin along. Within
// it the skin stays where it is and is pulled and pushed over; farther, solids would be moved
// through it, and it would be held on their wrong side.
constexpr double kLargestEdit = 0.05;

bool sameLayout(const GridLayout& a, const GridLayout& b) {
  return a.columns == b.columns && a.rows == b.rows;
}

// Whether both are skins of one mesh, in whatever order.
bool sameMesh(const Skin& a, const Skin& b) {
  if (!a.rigged() || !b.rigged() || a.pointCount() != b.pointCount()) return false;
  if (a.parts().shape == b.parts().shape) return true;
  const std::vector<std::uint32_t>&at = a.parts().meshRest->storageOf,
        &bt = b.parts().meshRest->storageOf;
  for (std::size_t p = 0; p < at.size(); ++p)
    if (pointAt(a.restPosition(), at[p]) != pointAt(b.restPosition(), bt[p])) return false;
  return true;
}

// Whether an entry of per-point arrays means the same point in both.
bool samePoints(const Skin& a, const Skin& b) {
  if (a.grid() && b.grid()) return sameLayout(a.grid()->layout(), b.grid()->layout());
  if (a.surface() && b.surface()) return a.parts().shape == b.parts().shape;
  return sameMesh(a, b) && a.isSimulated() == b.isSimulated() &&
         a.parts().meshRest->order == b.parts().meshRest->order;
}

// From one order of a mesh's points to another, and between a skin that is stepped and one that
// follows from its pose.
SkinState inOtherOrder(const Skin& from, const SkinState& state, const Skin& to) {
  const std::vector<std::uint32_t>& order = to.parts().meshRest->order;
  const std::vector<std::uint32_t>& storageOf = from.parts().meshRest->storageOf;
  const auto reordered = [&](const VectorArray& a) {
    VectorArray out(to.topology().storage());
    if (a.size() == 0) return out;
    for (std::size_t k = 0; k < order.size(); ++k)
      for (const auto axis : VectorArray::kAxes) (out.*axis)[k] = (a.*axis)[storageOf[order[k]]];
    return out;
  };
  SkinState out;
  out.joints = state.joints;
  out.starting = state.starting || !from.isSimulated();
  out.jiggle = state.jiggle;
  out.position = reordered(state.position);
  out.velocity = reordered(state.velocity);
  out.maxSpeed_m_per_s = state.maxSpeed_m_per_s;
  out.surroundings.resize(to.topology().storage());
  if (!state.ready || !from.isSimulated() || !to.isSimulated()) return out;
  out.surroundings.anchor = reordered(state.surroundings.anchor);
  out.surroundings.anchorVelocity = reordered(state.surroundings.anchorVelocity);
  out.ready = true;
  return out;
}

// The flesh of a mesh that follows from its pose swings on.
void carryOverJiggle(const Skin& from, const Skin& to, JiggleState& state) {
  if (!from.rigged() || !to.rigged()) return;
  const PoseSkin &before = *from.rigged()->skin, &now = *to.rigged()->skin;
  if (&before == &now) return;
  state = now.jiggle().carryOver(state, before.jiggle(), now.mesh().rest, before.mesh().rest);
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
  const bool same = samePoints(from, to), reordered = !same && sameMesh(from, to);
  if (!same && !reordered && !(from.grid() && to.grid())) return placedAnew(to, pose);
  SkinState coarser;  // of the grid that a fine one rides on
  const bool rode = from.coarse() && !state.coarse.empty();
  if (state.ready && to.coarse())
    coarser = rode ? carryOver(*from.coarse(), std::move(state.coarse.front()), *to.coarse(), pose)
                   : carryOver(from, state, *to.coarse(), pose);
  SkinState out = same        ? std::move(state)
                  : reordered ? inOtherOrder(from, state, to)
                              : onOtherGrid(from, state, to);
  // The edit is no motion: neither joints nor anchors have a velocity from it.
  if (!out.joints.empty()) out.joints.assign(pose.joints.begin(), pose.joints.end());
  carryOverJiggle(from, to, out.jiggle);
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

namespace {

bool allSized(std::size_t count, std::initializer_list<const VectorArray*> arrays) {
  return std::ranges::all_of(arrays, [&](const VectorArray* a) {
    return a->x.size() == count && a->y.size() == count && a->z.size() == count;
  });
}

bool isWhole(const JiggleState& jiggle) {
  const std::size_t count = jiggle.offset.size();
  return jiggle.velocity.size() == count && jiggle.place.size() == count &&
         jiggle.placeVelocity.size() == count;
}

}  // namespace

const char* misfit(const Skin& skin, const SkinState& state) {
  const std::size_t storage = skin.topology().storage();
  const PointSurroundings& around = state.surroundings;
  if (!allSized(storage, {&state.position})) return "positions";
  if (!allSized(storage, {&state.velocity})) return "velocities";
  if (!isWhole(state.jiggle)) return "jiggle";
  if (!around.fleshNormal.x.empty() && !allSized(storage, {&around.fleshNormal}))
    return "surroundings";
  if (!skin.isSimulated() || !state.ready) return nullptr;
  if (!allSized(storage,
                {&around.anchor, &around.anchorVelocity, &around.normal, &around.fleshVelocity}) ||
      around.offset.size() != storage)
    return "surroundings";
  const bool rides = skin.coarse() && skin.settings().integrator == "auto";
  if (!rides) return nullptr;
  if (state.coarse.size() != 1 || !state.coarse.front().ready ||
      !allSized(storage, {&state.coarseVelocity}))
    return "coarse grid";
  return misfit(*skin.coarse(), state.coarse.front());
}

}  // namespace fascia
