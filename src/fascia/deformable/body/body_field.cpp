#include <fascia/deformable/body/body_field.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/LU>

#include <fascia/base/assert.h>
#include <fascia/base/error.h>
#include <fascia/field/affine_kernels.h>
#include <fascia/geometry/box_tree.h>
#include <fascia/math/nearest_rotation.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

constexpr std::size_t kChunk = 64;  // points at a time, on the stack
// Beyond this part of its deformed box's diagonal a bent body is seen as that box.
constexpr double kFar = 0.5;

struct VectorChunk {
  alignas(kSimdAlignment) float x[kChunk], y[kChunk], z[kChunk];

  Vectors view(std::size_t count) { return {x, y, z, count}; }
};

template <class V>
V part(V v, std::size_t first, std::size_t count) {
  return {v.x + first, v.y + first, v.z + first, count};
}

Vec3 corner(const Box& box, std::size_t c) {
  return {c & 1 ? box.high.x() : box.low.x(), c & 2 ? box.high.y() : box.low.y(),
          c & 4 ? box.high.z() : box.low.z()};
}

void writeClearance(const BodyMap::Clearance& clearance, float& distance_m, Vectors normal,
                    std::size_t i) {
  distance_m = static_cast<float>(clearance.distance_m);
  setPoint(normal, i, clearance.away);
}

}  // namespace

BodyField::BodyField(const BodyModel& model, std::span<const BodySurfacePtr> surfaces) {
  if (surfaces.size() != model.bodyCount()) {
    Issue issue{{},
                "body field: found " + std::to_string(surfaces.size()) +
                    " surfaces, expected one for each of " + std::to_string(model.bodyCount()) +
                    " bodies",
                {}};
    throw Error(issue);
  }
  auto parts = std::make_shared<std::vector<Part>>();
  for (std::size_t b = 0; b < surfaces.size(); ++b) {
    if (!surfaces[b]) continue;
    const BodyId body(b);
    const BodyShapePtr& shape = model.sharedShape(body);
    parts->push_back({body, model.offset(body), static_cast<std::size_t>(shape->coordinateCount()),
                      surfaces[b]});
    posed_.push_back({BodyMap(shape, surfaces[b]->bounds_m(), surfaces[b]->mesh()), {}, {}});
    finish(parts->back(), posed_.back());
  }
  parts_ = std::move(parts);
}

void BodyField::update(std::span<const double> q, std::span<const double> v) {
  for (std::size_t i = 0; i < posed_.size(); ++i) {
    const Part& p = (*parts_)[i];
    FASCIA_ASSERT(p.first + p.count <= q.size() && q.size() == v.size(),
                  "the state is of these bodies");
    posed_[i].map.set(q.subspan(p.first, p.count), v.subspan(p.first, p.count));
    finish(p, posed_[i]);
  }
}

void BodyField::finish(const Part& part, Posed& posed) const {
  const BodyMap::Tangent& center = posed.map.center();
  posed.frame = {nearestRotation(center.gradient), center.x_m};
  const Transform frameFromWorld = posed.frame.inverse();
  const Box box = part.surface->bounds_m();
  // Corners alone would not tell when only what is between them moves.
  const std::array<Vec3, 3> bulges = posed.map.bulges();
  for (std::size_t c = 0; c < kOutline; ++c) {
    Vec3 x = posed.map.point(corner(box, c));
    for (std::size_t axis = 0; axis < 3; ++axis) x += (c >> axis & 1 ? 1 : -1) * bulges[axis];
    posed.outline[c] = frameFromWorld.point(x);
  }
}

void BodyField::evaluate(SolidId solid, ConstVectors points, float* distance_m,
                         Vectors normal) const {
  const bool affine = posed_[solid.index()].map.affine();
  FASCIA_ASSERT(solid.index() < posed_.size() && normal.count >= points.count,
                "the solid is of this field");
  for (std::size_t first = 0; first < points.count; first += kChunk) {
    const std::size_t count = std::min(kChunk, points.count - first);
    const ConstVectors chunk = part(points, first, count);
    const Vectors normals = part(normal, first, count);
    if (affine)
      evaluateAffine(solid.index(), chunk, distance_m + first, normals);
    else
      evaluateCurved(solid.index(), chunk, distance_m + first, normals);
  }
}

void BodyField::evaluateAffine(std::size_t solid, ConstVectors points, float* distance_m,
                               Vectors normal) const {
  const BodyMap& map = posed_[solid].map;
  const BodyMap::Inverse center = map.inverse(map.center().x_m);
  if (!center.found) {
    for (std::size_t i = 0; i < points.count; ++i)
      writeClearance(map.planeClearance(pointAt(points, i)), distance_m[i], normal, i);
    return;
  }
  const Mat3 inverse = center.gradient.inverse();
  VectorChunk X, n;
  affinePoints(inverse, map.center().x_m, map.center_m(), points, X.view(points.count));
  (*parts_)[solid].surface->evaluate(X.view(points.count), distance_m, n.view(points.count));
  affinePoints(inverse.transpose(), Vec3::Zero(), Vec3::Zero(), n.view(points.count), normal);
  for (std::size_t i = 0; i < points.count; ++i) {
    const float x = normal.x[i], y = normal.y[i], z = normal.z[i];
    const float scale = 1 / std::sqrt(x * x + y * y + z * z);
    distance_m[i] *= scale;
    normal.x[i] = x * scale, normal.y[i] = y * scale, normal.z[i] = z * scale;
  }
}

void BodyField::evaluateCurved(std::size_t solid, ConstVectors points, float* distance_m,
                               Vectors normal) const {
  const BodyMap& map = posed_[solid].map;
  const Box& bounds = map.bounds();
  const double far_m = kFar * bounds.size().norm();
  FASCIA_ASSERT(points.count <= kChunk, "points come in chunks");
  VectorChunk X, n;
  std::array<Mat3, kChunk> inverse;
  std::array<std::size_t, kChunk> mapped;  // which points they are
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 x = pointAt(points, i);
    const bool far = squaredDistance(bounds, x) > far_m * far_m;
    const BodyMap::Inverse found = far ? BodyMap::Inverse{} : map.inverse(x);
    if (far || !found.found) {
      writeClearance(far ? map.boxClearance(x) : map.planeClearance(x), distance_m[i], normal, i);
      continue;
    }
    setPoint(X.view(kChunk), count, found.X_m);
    inverse[count] = found.gradient.inverse();
    mapped[count++] = i;
  }
  std::array<float, kChunk> undeformed_m;
  (*parts_)[solid].surface->evaluate(X.view(count), undeformed_m.data(), n.view(count));
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 gradient = inverse[k].transpose() * pointAt(n.view(count), k);
    const double length = gradient.norm();
    distance_m[mapped[k]] = static_cast<float>(undeformed_m[k] / length);
    setPoint(normal, mapped[k], gradient / length);
  }
}

void BodyField::velocity(SolidId solid, ConstVectors points, Vectors velocity) const {
  FASCIA_ASSERT(solid.index() < posed_.size() && velocity.count >= points.count,
                "the solid is of this field");
  const BodyMap& map = posed_[solid.index()].map;
  if (map.affine()) {
    const BodyMap::Inverse center = map.inverse(map.center().x_m);
    const Mat3 rate = center.found ? Mat3(map.centerRate_per_s() * center.gradient.inverse())
                                   : Mat3(Mat3::Zero());
    affinePoints(rate, map.center().x_m, map.centerVelocity_m_per_s(), points, velocity);
    return;
  }
  for (std::size_t i = 0; i < points.count; ++i)
    setPoint(velocity, i, map.velocity(map.inverse(pointAt(points, i)).X_m));
}

Vec3 BodyField::materialFromWorld(SolidId solid, const Vec3& world) const {
  FASCIA_ASSERT(solid.index() < posed_.size(), "the solid is of this field");
  return posed_[solid.index()].map.inverse(world).X_m;
}

Vec3 BodyField::worldFromMaterial(SolidId solid, const Vec3& material) const {
  FASCIA_ASSERT(solid.index() < posed_.size(), "the solid is of this field");
  return posed_[solid.index()].map.point(material);
}

void BodyField::worldFromMaterials(SolidId solid, ConstVectors materials, Vectors world) const {
  const BodyMap& map = posed_[solid.index()].map;
  if (!map.affine()) return Field::worldFromMaterials(solid, materials, world);
  affinePoints(map.center().gradient, map.center_m(), map.center().x_m, materials, world);
}

}  // namespace fascia
