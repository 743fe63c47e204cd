#include <fascia/character/soft_flesh.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/suggest.h>

namespace fascia {
namespace {

constexpr int kSurfaceDetail = 24;  // segments around, of the mesh that is drawn
// Cells along the edge of a cube of the solid's volume. Mass costs once; every energy point costs
// in every step.
constexpr double kMassCells = 20, kEnergyCells = 7;
// Up to this degree the energy's points are thinned to as many as there are moments.
constexpr int kThinnedDegree = 8;

Matter matterOf(const Solid& solid, const SoftSolidDef& def, const Basis& basis) {
  const double edge_m = std::cbrt(solid.volume_m3());
  const MatterDetail detail = MatterDetail::of(basis);
  Matter matter = solidMatter(solid, def.density_kg_per_m3, edge_m / kMassCells, detail);
  if (detail.energy_degree > kThinnedDegree)
    matter.volume = solidMatter(solid, def.density_kg_per_m3, edge_m / kEnergyCells, detail).volume;
  return matter;
}

void validateHeld(const SoftSolidDef& def, const Box& bounds, const std::string& pointer,
                  Diagnostics& diagnostics) {
  if (def.held_m.size() > kMostHeldPoints)
    diagnostics.error(pointer, "found " + std::to_string(def.held_m.size()) +
                                   " points, expected at most " + std::to_string(kMostHeldPoints));
  for (std::size_t i = 0; i < def.held_m.size(); ++i) {
    const Vec3& p = def.held_m[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (p[axis] >= bounds.low[axis] && p[axis] <= bounds.high[axis]) continue;
      diagnostics.error(pointer + "/" + std::to_string(i) + "/" + std::to_string(axis),
                        "found " + shortNumber(p[axis]) + ", expected a number in [" +
                            shortNumber(bounds.low[axis]) + ", " + shortNumber(bounds.high[axis]) +
                            "], within the solid");
    }
  }
}

bool isSound(const FleshSolidDef& def, const Solid& solid, const std::string& pointer,
             Diagnostics& diagnostics) {
  const std::size_t errorsBefore = diagnostics.errors().size();
  validate(def.soft->basis, pointer + "/soft/basis", diagnostics);
  validateTunables(static_cast<const BodyMaterialDef&>(*def.soft), pointer + "/soft", diagnostics);
  validateHeld(*def.soft, solid.bounds(), pointer + "/soft/held_m", diagnostics);
  if (!def.drivers.empty())
    diagnostics.error(pointer + "/drivers",
                      "a soft solid takes its shape from forces: it cannot be driven",
                      "drop \"soft\", or the drivers");
  return diagnostics.errors().size() == errorsBefore;
}

}  // namespace

SoftFlesh::SoftFlesh(const FleshDef& def, const Flesh& flesh, const std::string& pointer,
                     Diagnostics& diagnostics) {
  std::vector<BodySurfacePtr> surfaces;
  softOf_.resize(flesh.solidCount());
  for (std::size_t i = 0; i < def.solids.size(); ++i) {
    const SolidId id(static_cast<std::int64_t>(i));
    const std::string at = pointer + "/" + std::to_string(i);
    if (!def.solids[i].soft || !isSound(def.solids[i], flesh.restSolid(id), at, diagnostics))
      continue;
    try {
      addPart(*def.solids[i].soft, flesh, id);
      softOf_[i] = SolidId(static_cast<std::int64_t>(surfaces.size()));
      surfaces.push_back(makeSolidSurface(flesh.restSolid(id), kSurfaceDetail));
    } catch (const Error& e) {
      for (const Issue& issue : e.issues())
        diagnostics.error(at + "/soft", issue.message, issue.hint);
    }
  }
  if (diagnostics.ok()) field_ = BodyField(model_, surfaces);
}

void SoftFlesh::addPart(const SoftSolidDef& soft, const Flesh& flesh, SolidId id) {
  const Solid& solid = flesh.restSolid(id);
  const BasisPtr basis = makeBasis(soft.basis, 3, solid.bounds());
  const BodyId body =
      model_.add(std::make_shared<BodyShape>(BodyDef{basis, matterOf(solid, soft, *basis), soft}));
  const Transform& inJoint = flesh.placeInJoint(id);
  const Vec3 joint_solid = inJoint.inverse().translation_m;
  parts_.push_back({id, body, flesh.joint(id), inJoint,
                    soft.held_m.empty() ? usualHeldPoints(solid, joint_solid, basis->degree() > 1)
                                        : soft.held_m});
}

void SoftFlesh::prepare(LayeredFlesh& flesh) const {
  if (!flesh.soft().sharesBodiesWith(field_)) flesh.setSoft(field_, softOf_);
}

void SoftFlesh::place(const PosedSkeleton& skeleton, OdeState& bodies) const {
  FASCIA_ASSERT(skeleton.joint_world.size() == skeleton.twist_world.size(),
                "the skeleton is posed");
  bodies.resize(model_.size());
  for (const Part& part : parts_) {
    const Transform& joint = skeleton.joint_world[part.joint.index()];
    model_.place(part.body, joint * part.inJoint, bodies);
  }
  setRigidVelocities(skeleton, bodies);
}

void SoftFlesh::setRigidVelocities(const PosedSkeleton& skeleton, OdeState& bodies) const {
  FASCIA_ASSERT(bodies.r.size() == model_.size() && bodies.v.size() == model_.size(),
                "the state is of these bodies");
  for (const Part& part : parts_)
    model_.shape(part.body).setRigidVelocity(
        model_.part(part.body, std::span<const double>(bodies.r)),
        skeleton.twist_world[part.joint.index()],
        model_.part(part.body, std::span<double>(bodies.v)));
}

void SoftFlesh::carry(const Part& part, const Transform& motion, OdeState& bodies) const {
  // momentumWeights() are those of the function 1, which the translation goes to.
  const BodyShape& shape = model_.shape(part.body);
  const Eigen::VectorXd& one = shape.momentumWeights();
  const auto r = model_.part(part.body, std::span<double>(bodies.r));
  const auto v = model_.part(part.body, std::span<double>(bodies.v));
  for (std::size_t j = 0; j < static_cast<std::size_t>(shape.shapeCount()); ++j) {
    Eigen::Map<Vec3> position(r.data() + 3 * j), velocity(v.data() + 3 * j);
    position = motion.vector(position) + one[static_cast<Eigen::Index>(j)] * motion.translation_m;
    velocity = motion.vector(velocity);
  }
}

std::vector<double> SoftFlesh::shapes(const OdeState& bodies) const {
  std::vector<double> out;
  out.reserve(model_.size());
  for (const Part& part : parts_) {
    const Eigen::MatrixXd R = model_.shape(part.body).shapeMatrix(
        model_.part(part.body, std::span<const double>(bodies.r)));
    out.insert(out.end(), R.data(), R.data() + R.size());
  }
  return out;
}

void SoftFlesh::setShapes(std::span<const double> shapes, double time_s, OdeState& bodies) const {
  FASCIA_ASSERT(shapes.size() == model_.size(), "shapes of these bodies");
  bodies.resize(model_.size());
  bodies.t_s = time_s;
  std::ranges::fill(bodies.v, 0.0);
  for (const Part& part : parts_) {
    const BodyShape& shape = model_.shape(part.body);
    const auto own = model_.part(part.body, shapes);
    shape.setShapeMatrix(Eigen::Map<const Eigen::MatrixXd>(own.data(), 3, shape.shapeCount()),
                         model_.part(part.body, std::span<double>(bodies.r)));
  }
}

}  // namespace fascia
