#include <fascia/world/placed_field.h>

#include <algorithm>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

constexpr std::size_t kBatch = 64;  // points at once, on the stack

struct Batch {
  float x[kBatch], y[kBatch], z[kBatch];
};

void transform(const Mat3& turn, const Vec3& shift, ConstVectors from, std::size_t first,
               std::size_t count, float* x, float* y, float* z) {
  const Eigen::Matrix3f R = turn.cast<float>();
  const Eigen::Vector3f t = shift.cast<float>();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f p =
        R * Eigen::Vector3f(from.x[first + i], from.y[first + i], from.z[first + i]) + t;
    x[i] = p.x(), y[i] = p.y(), z[i] = p.z();
  }
}

// Calls `visit` with batches of the points in the inner field's space, and their first index.
template <class Visit>
void inBatches(const Transform& back, ConstVectors points, const Visit& visit) {
  Batch local;
  for (std::size_t first = 0; first < points.count; first += kBatch) {
    const std::size_t count = std::min(kBatch, points.count - first);
    transform(back.rotation, back.translation_m, points, first, count, local.x, local.y, local.z);
    visit(ConstVectors{local.x, local.y, local.z, count}, first);
  }
}

void turn(const Mat3& rotation, std::size_t first, std::size_t count, Vectors vectors) {
  const ConstVectors from{vectors.x, vectors.y, vectors.z, first + count};
  transform(rotation, Vec3::Zero(), from, first, count, vectors.x + first, vectors.y + first,
            vectors.z + first);
}

Vectors from(Vectors vectors, std::size_t first) {
  FASCIA_ASSERT(first <= vectors.count, "the rest of the vectors");
  return {vectors.x + first, vectors.y + first, vectors.z + first, vectors.count - first};
}

}  // namespace

Box PlacedField::bounds(SolidId solid) const {
  const Box inner = field_->bounds(solid);
  Box out;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = (corner >> a & 1 ? inner.high : inner.low)[a];
    out.add(place_.point(p));
  }
  return out;
}

void PlacedField::evaluate(SolidId solid, ConstVectors points, float* distance_m,
                           Vectors normal) const {
  inBatches(back_, points, [&](ConstVectors local, std::size_t first) {
    field_->evaluate(solid, local, distance_m + first, from(normal, first));
    turn(place_.rotation, first, local.count, normal);
  });
}

void PlacedField::velocity(SolidId solid, ConstVectors points, Vectors velocity) const {
  inBatches(back_, points, [&](ConstVectors local, std::size_t first) {
    field_->velocity(solid, local, from(velocity, first));
    turn(place_.rotation, first, local.count, velocity);
  });
}

}  // namespace fascia
