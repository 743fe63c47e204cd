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

PoseSkin::Shape::Shape(const PoseSource& source, const std::vector<char>& rigidPoints)
    : mesh(makePoseMesh(source)),
      parts(std::make_shared<const LimbParts>(makeLimbParts(source, mesh))),
      jointCount(source.joints.size()),
      rigid(rigidPoints.empty() ? stiffPieces(source) : rigidPoints),
      base(source, mesh),
      spread(mesh, *parts) {
  FASCIA_ASSERT(parts->home.size() == mesh.size() && parts->part.size() == jointCount,
                "every point is of a part");
  FASCIA_ASSERT(rigid.size() == mesh.size(), "every point is rigid or not");
  contact = LimbContact(source, mesh, parts, rigid);
  std::vector<float> softness = softnessOf(source, mesh, *parts);
  FASCIA_ASSERT(softness.size() == mesh.size(), "a softness for each point");
  for (std::size_t i = 0; i < softness.size(); ++i)
    if (rigid[i]) softness[i] = 0;
  press = LimbPress(source, mesh, parts, softness);
  nesting = ShellNesting(source, mesh, rigid);
  morphs = MorphShapes(source, mesh.size());
}

PoseSkin::PoseSkin(const PoseSource& source, const PoseDials& dials)
    : shape_(std::make_shared<const Shape>(source, dials.rigid)) {
  makeStages(source, dials, nullptr);
}

PoseSkin::PoseSkin(const PoseSkin& before, const PoseSource& source, const PoseDials& dials)
    : shape_(before.shape_) {
  FASCIA_ASSERT(source.points.size() == pointCount() && source.joints.size() == jointCount(),
                "the same figure");
  FASCIA_ASSERT(dials.rigid.empty() || dials.rigid == shape_->rigid, "the same rigid points");
  makeStages(source, dials, &before);
}

bool PoseSkin::has(const PoseDials& dials) const {
  const std::vector<char>& rigid = shape_->rigid;
  return dials_.tightness == valuesOf(dials.tightness, rigid, PoseDials::kTightness) &&
         dials_.volume == valuesOf(dials.volume, rigid, PoseDials::kVolume) &&
         dials_.muscle == valuesOf(dials.muscle, rigid, PoseDials::kMuscle) &&
         dials_.jiggle == valuesOf(dials.jiggle, rigid, PoseDials::kJiggle);
}

// With `before`, of the same shape: its stages where their dials are the same.
void PoseSkin::makeStages(const PoseSource& source, const PoseDials& dials,
                          const PoseSkin* before) {
  const PoseMesh& mesh = shape_->mesh;
  const LimbParts& parts = *shape_->parts;
  dials_.tightness = valuesOf(dials.tightness, shape_->rigid, PoseDials::kTightness);
  dials_.volume = valuesOf(dials.volume, shape_->rigid, PoseDials::kVolume);
  dials_.muscle = valuesOf(dials.muscle, shape_->rigid, PoseDials::kMuscle);
  dials_.jiggle = valuesOf(dials.jiggle, shape_->rigid, PoseDials::kJiggle);
  const auto keeps = [&](std::vector<float> PoseDials::*dial) {
    return before && before->dials_.*dial == dials_.*dial;
  };
  elastic_ = keeps(&PoseDials::tightness)
                 ? before->elastic_
                 : std::make_shared<const ElasticLayer>(source, mesh, parts, dials_.tightness,
                                                        shape_->rigid);
  volume_ = keeps(&PoseDials::volume) ? before->volume_
                                      : std::make_shared<const JointVolume>(
                                            source, mesh, parts, shape_->spread, dials_.volume);
  muscles_ = keeps(&PoseDials::muscle) ? before->muscles_
                                       : std::make_shared<const MuscleSwell>(
                                             source, mesh, parts, shape_->spread, dials_.muscle);
  jiggle_ = keeps(&PoseDials::jiggle)
                ? before->jiggle_
                : std::make_shared<const Jiggle>(source, mesh, parts, dials_.jiggle);
}

// Joints relative to an origin that goes with the root: floats stay exact far away from the
// world's.
Vec3 PoseSkin::placeJoints(std::span<const Transform> motion, Scratch& scratch) const {
  FASCIA_ASSERT(motion.size() == jointCount(), "a motion for each joint");
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
  volume_->restore(scratch.joints, scratch.position, scratch.along);
  muscles_->swell(scratch.joints, scratch.along);
  forChunks(pointCount(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // Where limbs already press on each other flesh has nowhere to go.
      const float along = scratch.along[i] * LimbContact::freedom(scratch.contact, i);
      if (shape_->rigid[i] || std::abs(along) < 1e-8f) continue;
      const float most = kMostAlong * shape_->parts->radius_m[i];
      const float out = most * std::tanh(along / most);
      scratch.position[i] += out * (scratch.rotation[i] * wide(shape_->mesh.normal[i]));
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
  scratch.bend.resize(jointCount());
  forChunks(count, [&](std::size_t begin, std::size_t end) {
    shape_->base.place(scratch.joints, begin, end, scratch.position, scratch.turn,
                       scratch.rotation);
  });
  shape_->contact.measureBend(scratch.joints, scratch.bend);
  shape_->contact.meet(scratch.joints, scratch.bend, scratch.position, scratch.turn,
                       scratch.rotation, scratch.contact);
  elastic_->relax(scratch.rotation, scratch.position, scratch.elastic);
  displaceFlesh(scratch);
  shape_->morphs.move(moment.morphs, scratch.rotation, scratch.position);
  if (moment.jiggle && jiggle_->nodeCount() > 0) {
    jiggle_->step(moment.dt_s, scratch.position, origin, *moment.jiggle);
    jiggle_->add(*moment.jiggle, scratch.shown, scratch.position);
  }
  if (moment.obstacles)
    Dents::press(shape_->mesh, *moment.obstacles, origin, scratch.position, scratch.dents);
  shape_->press.press(scratch.joints, scratch.position, scratch.press);
  shape_->contact.finish(scratch.joints, scratch.rotation, scratch.position, scratch.contact);
  shape_->nesting.nest(scratch.joints, scratch.position, scratch.nesting);
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
