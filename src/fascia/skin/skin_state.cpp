#include <algorithm>

#include <fascia/skin/felt_contact.h>
#include <fascia/skin/flesh_contact.h>
#include <fascia/skin/resample.h>
#include <fascia/skin/skin.h>

namespace fascia {

void SkinState::addTo(StateHash& hash, const SkinTopology& topology) const {
  for (const VectorArray* a : {&position, &velocity})
    for (const FloatArray* axis : {&a->x, &a->y, &a->z})
      for (const SkinTopology::Range& r : topology.ranges())
        hash.add(axis->data() + r.first, r.count * sizeof(float));
}

void Skin::placeAnchors(const SkinPose& pose, CarryScratch& scratch, VectorArray& out) const {
  if (isGrid())
    anchors_.place(*pose.field, scratch.points, out);
  else
    anchorsByJoints_.place(pose.joints, scratch.motion, out);
}

void Skin::keepVolume(const SkinPose& pose, CarryScratch& scratch, VectorArray& anchor) const {
  if (jointVolume_.empty()) return;
  fixedByJoints_.place(pose.joints, scratch.motion, anchor);
  jointVolume_.restore(keptVolume_, scratch.motion, scratch.volume, anchor);
}

void Skin::placeFixed(const SkinPose& pose, CarryScratch& scratch, VectorArray& out) const {
  fixedByJoints_.place(pose.joints, scratch.motion, out);
  for (const Fixed& f : fixed_) {
    const Vec3 p = pose.joints[f.joint.index()].point(f.position_joint);
    out.x[f.point] = static_cast<float>(p.x());
    out.y[f.point] = static_cast<float>(p.y());
    out.z[f.point] = static_cast<float>(p.z());
  }
}

void Skin::placeAll(const SkinPose& pose, CarryScratch& scratch, VectorArray& out) const {
  if (isGrid())
    carriers_.place(*pose.field, scratch.points, out);
  else
    allByJoints_.place(pose.joints, scratch.motion, out);
  placeFixed(pose, scratch, out);
  topology_->complete(out);
}

void carrySkin(const Skin& skin, const SkinPose& pose, SkinState& state) {
  const std::size_t storage = skin.topology().storage();
  CarryScratch scratch;
  state.position.resize(storage);
  state.velocity.resize(storage);
  state.velocity.fill(0.f);
  skin.placeAll(pose, scratch, state.position);
}

std::unique_ptr<SkinContact> makeContact(const Skin& skin) {
  if (skin.sense()) return std::make_unique<FeltContact>(*skin.sense());
  return std::make_unique<FleshContact>(
      std::vector<PointBlock>(skin.blocks().begin(), skin.blocks().end()));
}

void measureSkin(const Skin& skin, const SkinPose& pose, const SkinState& state, SkinStats& stats) {
  const std::unique_ptr<SkinContact> contact = makeContact(skin);
  contact->findYielding(*pose.field, skin.points(), state.surroundings.anchor);
  stats.max_penetration_m = std::max<double>(
      stats.max_penetration_m, contact->deepest(*pose.field, skin.points(), state.position));
  stats.max_edge_stretch =
      std::max(stats.max_edge_stretch, skin.topology().maxStretch(state.position));
}

SkinState resampled(const Skin& from, const SkinState& state, const Skin& to) {
  SkinState out;
  out.position = resample(from.layout(), state.position, to.layout());
  out.velocity = resample(from.layout(), state.velocity, to.layout());
  out.maxSpeed_m_per_s = state.maxSpeed_m_per_s;
  return out;
}

void skinSurface(const Skin& skin, const SkinState& state, TriangleMesh& mesh) {
  skin.topology().surface(state.position, mesh);
}

}  // namespace fascia
