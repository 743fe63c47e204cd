#include <algorithm>
#include <atomic>

#include <fascia/skin/contact/face_depth.h>
#include <fascia/skin/contact/face_lift.h>
#include <fascia/skin/contact/flesh_contact.h>
#include <fascia/skin/grid/resample.h>
#include <fascia/skin/grid_skin_builder.h>
#include <fascia/skin/mesh_skin_builder.h>
#include <fascia/skin/surface_skin_builder.h>

namespace fascia {
namespace {

std::uint64_t nextSkinId() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

// Where a state's points are shown.
const VectorArray& shown(const Skin& skin, const DistanceField& flesh, const SkinState& state,
                         VectorArray& lifted) {
  const FaceSamples* faces = skin.parts().shape->faces.get();
  if (!faces) return state.position;
  lifted = state.position;
  liftFaces(*faces, flesh, skin.points(), static_cast<float>(kFaceClearance * skin.size_m()),
            kShownLift * skin.topology().allowedStretch(), lifted);
  skin.topology().complete(lifted);
  return lifted;
}

SkinParts build(const SkinDef& def, const SkinSettings& settings, const SkinBase& base,
                const Skin* before, const std::string& pointer, Diagnostics& diagnostics) {
  if (base.rig) return MeshSkinBuilder(def, settings, base, before, pointer, diagnostics).build();
  if (before && (before->surface() != nullptr) != def.surface.has_value()) before = nullptr;
  if (def.surface) return SurfaceSkinBuilder(def, base, before, pointer, diagnostics).build();
  return GridSkinBuilder(def, settings, base, before, pointer, diagnostics).build();
}

}  // namespace

Skin::Skin(const SkinDef& def, const SkinSettings& settings, const SkinBase& base,
           const std::string& pointer, Diagnostics& diagnostics, const Skin* before)
    : Skin(settings, build(def, settings, base, before, pointer, diagnostics)) {}

Skin::Skin(const SkinSettings& settings, SkinParts parts)
    : id_(nextSkinId()), settings_(settings), parts_(std::move(parts)) {}

std::unique_ptr<SkinContact> Skin::makeContact() const {
  return std::make_unique<FleshContact>(parts_.shape->blocks);
}

void SkinState::addTo(StateHash& hash, const SkinTopology& topology) const {
  for (const VectorArray* a : {&position, &velocity})
    for (const FloatArray* axis : {&a->x, &a->y, &a->z})
      for (const SkinTopology::Range& r : topology.ranges())
        hash.add(axis->data() + r.first, r.count * sizeof(float));
  for (const FrameArray* a : {&jiggle.offset, &jiggle.velocity})
    hash.add(a->data(), a->size() * sizeof(Vector4f));
}

void placeSkin(const Skin& skin, const SkinPose& pose, SkinState& state) {
  const std::size_t storage = skin.topology().storage();
  state.position.resize(storage);
  state.velocity.resize(storage);
  state.velocity.fill(0.f);
  skin.attachment().makePlacer()->placeAll(pose, state.position);
  skin.topology().complete(state.position);
  state.jiggle = {};
}

void measureSkin(const Skin& skin, const SkinPose& pose, const SkinState& state, SkinStats& stats) {
  const std::unique_ptr<SkinContact> contact = skin.makeContact();
  stats.max_penetration_m = std::max<double>(
      stats.max_penetration_m, contact->deepest(*pose.field, skin.points(), state.position));
  VectorArray lifted;
  stats.max_edge_stretch = std::max(
      stats.max_edge_stretch, skin.topology().maxStretch(shown(skin, *pose.field, state, lifted)));
}

void measureFaces(const DistanceField& flesh, const TriangleMesh& surface, SkinStats& stats) {
  stats.max_face_depth_m = std::max(stats.max_face_depth_m, deepestFace(flesh, surface));
}

SkinState resampled(const Skin& from, const SkinState& state, const Skin& to) {
  const GridLayout &source = from.grid()->layout(), &target = to.grid()->layout();
  SkinState out;
  out.position = resample(source, state.position, target);
  out.velocity = resample(source, state.velocity, target);
  out.maxSpeed_m_per_s = state.maxSpeed_m_per_s;
  return out;
}

void skinSurface(const Skin& skin, const DistanceField& flesh, const SkinState& state,
                 TriangleMesh& mesh) {
  VectorArray lifted;
  skin.topology().surface(shown(skin, flesh, state, lifted), mesh);
}

}  // namespace fascia
