#include <fascia/pose/pose_skin.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/pose/softness.h>

namespace fascia {
namespace {

constexpr std::size_t kPointsPerTask = 512;
constexpr float kMostAlong = 0.2f;  // displacement of flesh along the normal, in local radii

// A dial's values; 0 where the skin is rigid.
std::vector<float> valuesOf(const std::vector<float>& dial, std::span<const char> rigid,
                            float usual) {
  std::vector<float> values = dial.empty() ? std::vector<float>(rigid.size(), usual) : dial;
  for (std::size_t i = 0; i < rigid.size(); ++i)
    if (rigid[i]) values[i] = 0;
  return values;
}

template <class Task>
void forChunks(std::size_t count, const Task& task) {
  parallelFor((count + kPointsPerTask - 1) / kPointsPerTask, [&](std::size_t chunk) {
    task(kPointsPerTask * chunk, std::min(count, kPointsPerTask * (chunk + 1)));
  });
}

}  // namespace

PoseSkin::PoseSkin(const PoseSource& source, const PoseDials& dials)
    : mesh_(makePoseMesh(source)), jointCount_(source.joints.size()) {
  parts_ = std::make_shared<const LimbParts>(makeLimbParts(source, mesh_));
  FASCIA_ASSERT(parts_->home.size() == mesh_.size() && parts_->part.size() == jointCount_,
                "every point is of a part");
  base_ = BasePose(source, mesh_);
  rigid_ = dials.rigid.empty() ? stiffPieces(source) : dials.rigid;
  FASCIA_ASSERT(rigid_.size() == mesh_.size(), "every point is rigid or not");
  contact_ = LimbContact(source, mesh_, parts_, rigid_);
  elastic_ = ElasticLayer(source, mesh_, *parts_,
                          valuesOf(dials.tightness, rigid_, PoseDials::kTightness), rigid_);
  const SkinSpread spread(mesh_, *parts_);
  volume_ = JointVolume(source, mesh_, *parts_, spread,
                        valuesOf(dials.volume, rigid_, PoseDials::kVolume));
  muscles_ = MuscleSwell(source, mesh_, *parts_, spread,
                         valuesOf(dials.muscle, rigid_, PoseDials::kMuscle));
  jiggle_ = Jiggle(source, mesh_, *parts_, valuesOf(dials.jiggle, rigid_, PoseDials::kJiggle));
  std::vector<float> softness = softnessOf(source, mesh_, *parts_);
  FASCIA_ASSERT(softness.size() == mesh_.size(), "a softness for each point");
  for (std::size_t i = 0; i < softness.size(); ++i)
    if (rigid_[i]) softness[i] = 0;
  press_ = LimbPress(source, mesh_, parts_, softness);
  nesting_ = ShellNesting(source, mesh_, rigid_);
}

// Joints relative to an origin that goes with the root: floats stay exact far away from the
// world's.
Vec3 PoseSkin::placeJoints(std::span<const Transform> motion, Scratch& scratch) const {
  FASCIA_ASSERT(motion.size() == jointCount_, "a motion for each joint");
  const Vec3 origin = motion.empty() ? Vec3::Zero().eval() : motion[0].translation_m;
  scratch.joints.clear();
  for (const Transform& t : motion)
    scratch.joints.push_back(jointMotion({t.rotation, t.translation_m - origin}));
  return origin;
}

// Volume and muscles along the normals, no farther than flesh goes.
void PoseSkin::displaceFlesh(Scratch& scratch) const {
  FASCIA_ASSERT(scratch.position.size() == pointCount() && scratch.rotation.size() == pointCount(),
                "the points are placed");
  scratch.along.assign(pointCount(), 0.f);
  volume_.restore(scratch.joints, scratch.position, scratch.along);
  muscles_.swell(scratch.joints, scratch.along);
  forChunks(pointCount(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // Where limbs already press on each other flesh has nowhere to go.
      const float along = scratch.along[i] * LimbContact::freedom(scratch.contact, i);
      if (rigid_[i] || std::abs(along) < 1e-8f) continue;
      const float most = kMostAlong * parts_->radius_m[i];
      const float out = most * std::tanh(along / most);
      scratch.position[i] += out * (scratch.rotation[i] * wide(mesh_.normal[i]));
    }
  });
}

void PoseSkin::evaluate(std::span<const Transform> motion, const Moment& moment, Scratch& scratch,
                        VectorArray& out) const {
  const std::size_t count = pointCount();
  const Vec3 origin = placeJoints(motion, scratch);
  FASCIA_ASSERT(out.size() >= count, "a place for each point");
  scratch.position.resize(count);
  scratch.turn.resize(count);
  scratch.rotation.resize(count);
  scratch.bend.resize(jointCount_);
  forChunks(count, [&](std::size_t begin, std::size_t end) {
    base_.place(scratch.joints, begin, end, scratch.position, scratch.turn, scratch.rotation);
  });
  contact_.measureBend(scratch.joints, scratch.bend);
  contact_.meet(scratch.joints, scratch.bend, scratch.position, scratch.turn, scratch.rotation,
                scratch.contact);
  elastic_.relax(scratch.rotation, scratch.position, scratch.elastic);
  displaceFlesh(scratch);
  if (moment.jiggle && jiggle_.nodeCount() > 0) {
    jiggle_.step(moment.dt_s, scratch.position, origin, *moment.jiggle);
    jiggle_.add(*moment.jiggle, scratch.shown, scratch.position);
  }
  if (moment.obstacles)
    Dents::press(mesh_, *moment.obstacles, origin, scratch.position, scratch.dents);
  press_.press(scratch.joints, scratch.position, scratch.press);
  contact_.finish(scratch.joints, scratch.rotation, scratch.position, scratch.contact);
  nesting_.nest(scratch.joints, scratch.position, scratch.nesting);
  const Eigen::Vector3f shift = origin.cast<float>();
  forChunks(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      out.x[i] = scratch.position[i].x() + shift.x();
      out.y[i] = scratch.position[i].y() + shift.y();
      out.z[i] = scratch.position[i].z() + shift.z();
    }
  });
}

}  // namespace fascia
