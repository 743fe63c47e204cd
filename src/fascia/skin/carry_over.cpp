#include <fascia/skin/carry_over.h>

#include <utility>

#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/grid/resample.h>

namespace fascia {
namespace {

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
  to.attachment().makePlacer()->placeAnchors(pose, out.surroundings.anchor);
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
