#include <fascia/field/solid.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/suggest.h>

namespace fascia {

namespace {

constexpr int kVolumeDetail = 96;  // a deformed solid's volume is within about 0.5 % at this detail

template <class T>
void reportUnknown(const std::string& pointer, const std::string& found,
                   std::span<const T* const> all, Diagnostics& diagnostics) {
  NearestName nearest(found);
  std::string list;
  for (const T* one : all) {
    nearest.offer(one->name());
    list += (list.empty() ? "" : ", ") + quotedName(one->name());
  }
  diagnostics.error(pointer, "found " + quotedName(found) + ", expected one of " + list,
                    nearest.hint());
}

}  // namespace

KernelFrame kernelFrame(const Transform& world) {
  KernelFrame frame;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) frame.rotation[i][j] = static_cast<float>(world.rotation(i, j));
    frame.translation_m[i] = static_cast<float>(world.translation_m[i]);
  }
  return frame;
}

void Shape::evaluate(std::span<const double> p, ConstVectors points, float* distance_m,
                     Vectors normal) const {
  SolidKernel solid;
  solid.primitive = kernel(p);
  evaluateKernel(solid, KernelFrame{}, points, distance_m, normal);
}

Solid::Solid(const SolidDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  auto layout = std::make_shared<Layout>();
  readShape(def, pointer, diagnostics, *layout);
  if (def.deformations.size() > kMaxDeformations) {
    diagnostics.error(pointer + "/deformations",
                      "found " + std::to_string(def.deformations.size()) +
                          " deformations, expected at most " + std::to_string(kMaxDeformations));
  }
  const std::size_t count = std::min(def.deformations.size(), kMaxDeformations);
  for (std::size_t i = 0; i < count; ++i) {
    readStep(def.deformations[i], pointer + "/deformations/" + std::to_string(i), diagnostics,
             *layout);
  }
  layout_ = std::move(layout);
  effective_ = values_;
  refresh();
}

void Solid::readShape(const SolidDef& def, const std::string& pointer, Diagnostics& diagnostics,
                      Layout& layout) {
  const Shape* shape = findShape(def.shape);
  if (!shape) {
    reportUnknown(pointer + "/shape", def.shape, shapes(), diagnostics);
    shape = shapes().front();
  }
  layout.shape = shape;
  const bool known = shape->name() == def.shape;
  addParameters(shape->parameters(), known ? def.parameters : std::vector<double>{}, "", pointer,
                diagnostics, layout);
  layout.shapeCount = values_.size();
}

void Solid::readStep(const SolidDef::Step& step, const std::string& pointer,
                     Diagnostics& diagnostics, Layout& layout) {
  const Deformation* type = findDeformation(step.type);
  if (!type) {
    reportUnknown(pointer + "/type", step.type, deformations(), diagnostics);
    return;
  }
  const auto same = std::count_if(layout.steps.begin(), layout.steps.end(),
                                  [type](const Step& s) { return s.type == type; });
  const std::string prefix = step.type + (same > 0 ? std::to_string(same + 1) : "") + ".";
  const std::size_t first = values_.size();
  addParameters(type->parameters(), step.parameters, prefix, pointer, diagnostics, layout);
  layout.steps.push_back({type, first, values_.size() - first});
}

void Solid::addParameters(std::span<const ParameterInfo> infos, std::span<const double> given,
                          const std::string& prefix, const std::string& pointer,
                          Diagnostics& diagnostics, Layout& layout) {
  if (given.size() > infos.size()) {
    diagnostics.error(pointer, "found " + std::to_string(given.size()) +
                                   " parameters, expected at most " + std::to_string(infos.size()));
  }
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const ParameterInfo& info = infos[i];
    double value = i < given.size() ? given[i] : info.standard;
    if (!(value >= info.min && value <= info.max)) {
      diagnostics.error(pointer + "/" + std::string(info.name),
                        "found " + shortNumber(value) + ", expected a number in [" +
                            shortNumber(info.min) + ", " + shortNumber(info.max) + "]");
      value = info.standard;
    }
    values_.push_back(value);
    layout.infos.push_back(&info);
    layout.paths.push_back(prefix + std::string(info.name));
  }
}

int Solid::parameterIndex(std::string_view path) const {
  const auto& paths = layout_->paths;
  const auto found = std::find(paths.begin(), paths.end(), path);
  return found == paths.end() ? -1 : static_cast<int>(found - paths.begin());
}

bool Solid::write(std::size_t index, double value) {
  FASCIA_ASSERT(index < values_.size() && layout_->infos.size() == values_.size(),
                "the parameter exists");
  double& current = values_[index];
  if (std::isnan(value)) return false;
  const ParameterInfo& info = *layout_->infos[index];
  value = std::clamp(value, info.min, info.max);
  if (value == current) return false;
  current = value;
  return true;
}

void Solid::setParameter(int index, double value) {
  if (write(static_cast<std::size_t>(index), value)) refresh();
}

void Solid::setParameters(std::span<const double> values) {
  FASCIA_ASSERT(values.size() == values_.size(), "a value for each parameter");
  bool changed = false;
  for (std::size_t i = 0; i < values.size(); ++i) changed = write(i, values[i]) || changed;
  if (changed) refresh();
}

void Solid::refresh() {
  const Shape& primitive = *layout_->shape;
  const PrimitiveKernel before = kernel_.primitive;
  halfExtents_m_ = primitive.halfExtents_m(shapeParameters());
  FASCIA_ASSERT((halfExtents_m_.array() > 0).all(), "a shape has a size");
  kernel_.primitive = primitive.kernel(shapeParameters());
  kernel_.deformationCount = 0;
  bounds_ = {-halfExtents_m_, halfExtents_m_};
  std::copy(values_.begin(), values_.end(), effective_.begin());
  const double zHalf_m = halfExtents_m_.z();
  for (const Step& step : layout_->steps) {
    effective_[step.first] = step.type->invertibleAmount(stepParameters(step), zHalf_m, bounds_);
    const auto parameters = stepParameters(step);
    const Box undeformed = bounds_;
    bounds_ = step.type->bounds(parameters, zHalf_m, undeformed);
    FASCIA_ASSERT(!bounds_.empty(), "a deformed solid has bounds");
    // The identity is left out: it costs nothing then, and no kernel divides by its amount.
    if (effective_[step.first] != 0) {
      kernel_.deformations[kernel_.deformationCount++] =
          step.type->kernel(parameters, zHalf_m, undeformed);
    }
  }
  refreshOutline(before);
}

// The corners (±a, ±b, ±c), farther out by as much of them as is inside of the surface: the one
// part of their place that exponents change.
void Solid::refreshOutline(const PrimitiveKernel& before) {
  const PrimitiveKernel& now = kernel_.primitive;
  if (cornerGauge_ == 0 || now.kind == PrimitiveKernel::Kind::capsule ||
      now.northSouthPower != before.northSouthPower || now.eastWestPower != before.eastWestPower)
    cornerGauge_ = shape().gauge(shapeParameters(), halfExtents_m_);
  const Vec3 corner = (1 + 1 / cornerGauge_) * halfExtents_m_;
  FASCIA_ASSERT(cornerGauge_ > 0 && corner.allFinite(),
                "the corner of a box is outside of the shape");
  for (std::size_t c = 0; c < outline_m_.size(); ++c)
    outline_m_[c] = deformedFromShape(
        corner.cwiseProduct(Vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1)));
}

double Solid::volume_m3() const {
  if (!deformed()) return shape().volume_m3(shapeParameters());
  return enclosedVolume(tessellate(kVolumeDetail));
}

TriangleMesh Solid::tessellate(int detail) const {
  TriangleMesh mesh = shape().tessellate(shapeParameters(), detail);
  for (std::size_t i = 0; deformed() && i < mesh.positions.size(); ++i) {
    const Vec3 x = mesh.positions[i].cast<double>();
    const Vec3 n = mesh.normals[i].cast<double>();
    mesh.positions[i] = deformedFromShape(x).cast<float>();
    mesh.normals[i] = (deformationJacobian(x).inverse().transpose() * n).normalized().cast<float>();
  }
  return mesh;
}

void Solid::evaluate(ConstVectors points_local, float* distance_m, Vectors normal_local) const {
  evaluateKernel(kernel_, KernelFrame{}, points_local, distance_m, normal_local);
}

void evaluatePosed(const Solid& solid, const Transform& world, ConstVectors points_world,
                   float* distance_m, Vectors normal_world) {
  FASCIA_ASSERT(normal_world.count >= points_world.count, "a normal for each point");
  evaluateKernel(solid.kernel(), kernelFrame(world), points_world, distance_m, normal_world);
}

Vec3 Solid::deformedFromShape(const Vec3& x) const {
  Vec3 y = x;
  for (const Step& step : layout_->steps) {
    y = step.type->forward(stepParameters(step), halfExtents_m_.z(), y);
  }
  return y;
}

Mat3 Solid::deformationJacobian(const Vec3& x) const {
  Mat3 jacobian = Mat3::Identity();
  Vec3 y = x;
  for (const Step& step : layout_->steps) {
    jacobian = step.type->jacobian(stepParameters(step), halfExtents_m_.z(), y) * jacobian;
    y = step.type->forward(stepParameters(step), halfExtents_m_.z(), y);
  }
  return jacobian;
}

Mat3 Solid::distanceJacobian(const Vec3& x) const {
  Mat3 jacobian = Mat3::Identity();
  Vec3 y = x;
  Box box{-halfExtents_m_, halfExtents_m_};
  for (const Step& step : layout_->steps) {
    const auto parameters = stepParameters(step);
    const double zHalf_m = halfExtents_m_.z();
    jacobian = step.type->jacobian(parameters, zHalf_m, step.type->tangentPoint(y, box)) * jacobian;
    y = step.type->forward(parameters, zHalf_m, y);
    box = step.type->bounds(parameters, zHalf_m, box);
  }
  return jacobian;
}

Vec3 Solid::shapeFromDeformed(const Vec3& x) const {
  Vec3 y = x;
  for (auto step = layout_->steps.rbegin(); step != layout_->steps.rend(); ++step) {
    y = step->type->inverse(stepParameters(*step), halfExtents_m_.z(), y);
  }
  return y;
}

Vec3 Solid::materialFromLocal(const Vec3& local) const {
  FASCIA_ASSERT(local.allFinite(), "places are finite");
  const Vec3 x = shapeFromDeformed(local);
  const Vec3 u = x.cwiseQuotient(halfExtents_m_);
  const double length = u.norm();
  return length > 0 ? Vec3(u * (shape().gauge(shapeParameters(), x) / length)) : Vec3::Zero();
}

Vec3 Solid::localFromMaterial(const Vec3& material) const {
  FASCIA_ASSERT(material.allFinite(), "material coordinates are finite");
  const Vec3 x = material.cwiseProduct(halfExtents_m_);
  const double gauge = shape().gauge(shapeParameters(), x);
  return deformedFromShape(gauge > 0 ? Vec3(x * (material.norm() / gauge)) : Vec3::Zero());
}

}  // namespace fascia
