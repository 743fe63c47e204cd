#include <algorithm>

#include <fascia/base/assert.h>
#include <fascia/skin/contact/flesh_contact.h>
#include <fascia/skin/grid/resample.h>
#include <fascia/skin/mesh/rigged_skin.h>
#include <fascia/skin/skin.h>

namespace fascia {

void SkinState::addTo(StateHash& hash, const SkinTopology& topology) const {
  for (const VectorArray* a : {&position, &velocity})
    for (const FloatArray* axis : {&a->x, &a->y, &a->z})
      for (const SkinTopology::Range& r : topology.ranges())
        hash.add(axis->data() + r.first, r.count * sizeof(float));
  for (const FrameArray* a : {&jiggle.offset, &jiggle.velocity})
    hash.add(a->data(), a->size() * sizeof(Vector4f));
}

namespace {

// A pose's joints as the rig's: rest -> now.
void rigMotion(const RiggedSkin& rigged, const SkinPose& pose, std::vector<Transform>& motion) {
  FASCIA_ASSERT(
      std::ranges::all_of(rigged.joints,
                          [&](const auto& j) { return j.skeletonJoint < pose.joints.size(); }),
      "the pose has the rig's joints");
  motion.clear();
  for (const RiggedSkin::Joint& j : rigged.joints)
    motion.push_back(pose.joints[j.skeletonJoint] * j.inverseRest);
}

}  // namespace

void evaluateRigged(const RiggedSkin& rigged, const SkinPose& pose, double dt_s,
                    JiggleState* jiggle, CarryScratch& scratch, VectorArray& out) {
  FASCIA_ASSERT(pose.field && rigged.skin, "a rig is posed on flesh");
  rigMotion(rigged, pose, scratch.motion);
  PoseObstacles obstacles{pose.field, rigged.fleshSolids};
  rigged.skin->evaluate(scratch.motion, {dt_s, jiggle, &obstacles}, scratch.pose, out);
  rigged.soft.move(*pose.field, pose.joints, scratch.soft, out);
}

void Skin::placeAnchors(const SkinPose& pose, CarryScratch& scratch, VectorArray& out) const {
  FASCIA_ASSERT(out.size() >= topology_->storage(), "a place for each point");
  if (isGrid()) {
    anchors_.place(*pose.field, scratch.points, out);
    return;
  }
  placeRigged(pose, scratch);
  // A strand's inner end lies above its point in the rest posture, and turns with the limb.
  for (std::size_t k = 0; k < pointCount(); ++k) {
    const Vector4f sag = scratch.pose.rotation[k] * Vector4f(sag_.x[k], sag_.y[k], sag_.z[k], 0);
    out.x[k] = scratch.points.x[k] - sag.x();
    out.y[k] = scratch.points.y[k] - sag.y();
    out.z[k] = scratch.points.z[k] - sag.z();
  }
}

void Skin::placeFixed(const SkinPose& pose, CarryScratch& scratch, VectorArray& out) const {
  FASCIA_ASSERT(out.size() >= topology_->storage(), "a place for each point");
  if (!isGrid())
    for (const std::size_t k : fixedPoints_)
      for (const auto axis : VectorArray::kAxes) (out.*axis)[k] = (scratch.points.*axis)[k];
  for (const Fixed& f : fixed_) {
    const Vec3 p = pose.joints[f.joint.index()].point(f.position_joint);
    out.x[f.point] = static_cast<float>(p.x());
    out.y[f.point] = static_cast<float>(p.y());
    out.z[f.point] = static_cast<float>(p.z());
  }
}

void Skin::placeAll(const SkinPose& pose, CarryScratch& scratch, VectorArray& out) const {
  FASCIA_ASSERT(out.size() >= topology_->storage(), "a place for each point");
  if (isGrid()) {
    carriers_.place(*pose.field, scratch.points, out);
  } else {
    placeRigged(pose, scratch);
    for (const auto axis : VectorArray::kAxes)
      std::copy_n((scratch.points.*axis).begin(), pointCount(), (out.*axis).begin());
  }
  placeFixed(pose, scratch, out);
  topology_->complete(out);
}

void Skin::placeRigged(const SkinPose& pose, CarryScratch& scratch) const {
  scratch.points.resize(topology_->storage());
  evaluateRigged(*rigged_, pose, 0, nullptr, scratch, scratch.points);
}

void carrySkin(const Skin& skin, const SkinPose& pose, SkinState& state) {
  const std::size_t storage = skin.topology().storage();
  CarryScratch scratch;
  state.position.resize(storage);
  state.velocity.resize(storage);
  state.velocity.fill(0.f);
  skin.placeAll(pose, scratch, state.position);
  state.jiggle = {};
}

std::unique_ptr<SkinContact> makeContact(const Skin& skin) {
  return std::make_unique<FleshContact>(
      std::vector<PointBlock>(skin.blocks().begin(), skin.blocks().end()));
}

void measureSkin(const Skin& skin, const SkinPose& pose, const SkinState& state, SkinStats& stats) {
  const std::unique_ptr<SkinContact> contact = makeContact(skin);
  stats.max_penetration_m = std::max<double>(
      stats.max_penetration_m, contact->deepest(*pose.field, skin.points(), state.position));
  stats.max_edge_stretch =
      std::max(stats.max_edge_stretch, skin.topology().maxStretch(state.position));
}

SkinState resampled(const Skin& from, const SkinState& state, const Skin& to) {
  FASCIA_ASSERT(from.isGrid() && to.isGrid(), "only grids change their resolution");
  FASCIA_ASSERT(state.position.size() == from.topology().storage(), "the state is of this skin");
  SkinState out;
  out.position = resample(from.layout(), state.position, to.layout());
  out.velocity = resample(from.layout(), state.velocity, to.layout());
  out.maxSpeed_m_per_s = state.maxSpeed_m_per_s;
  return out;
}

void skinSurface(const Skin& skin, const SkinState& state, TriangleMesh& mesh) {
  FASCIA_ASSERT(state.position.size() == skin.topology().storage(), "the state is of this skin");
  skin.topology().surface(state.position, mesh);
}

}  // namespace fascia
