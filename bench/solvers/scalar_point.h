#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/skin.h>

#include "solvers/scheme.h"

// What the compared schemes share: single points in plain scalar code.
namespace fascia {

using Vec3f = Eigen::Vector3f;
using Mat3f = Eigen::Matrix3f;

inline Vec3f at(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}
inline void put(VectorArray& a, std::size_t k, const Vec3f& v) {
  a.x[k] = v.x(), a.y[k] = v.y(), a.z[k] = v.z();
}

inline Vec3f gravityOf(const Skin& skin) {
  return skin.settings().gravity_m_per_s2.cast<float>();
}

// Indices of a grid point's neighbours, storage order; the tube is closed around.
struct Cell {
  std::size_t self, right, up, upRight;
  Cell(const GridLayout& g, int i, int j)
      : self(g.at(i, j)),
        right(g.at(g.wrapped(i + 1), j)),
        up(g.at(i, j + 1)),
        upRight(g.at(g.wrapped(i + 1), j + 1)) {}
};

// A cell's mean sides: s1 = Σ kAlpha r, s2 = Σ kBeta r over self, right, up, upRight.
inline constexpr float kAlpha[4] = {-0.5f, 0.5f, -0.5f, 0.5f};
inline constexpr float kBeta[4] = {-0.5f, -0.5f, 0.5f, 0.5f};

// A tissue strand (Turner & Gobbetti 1998, eq. 3) at one moment.
struct Strand {
  Vec3f direction = Vec3f::Zero();  // from the anchor, unit
  float length = 0, extension = 0;  // m; extension > 0: taut
};
inline Strand strandAt(const PointModel& points, const PointSurroundings& around, std::size_t k,
                       float time_s, const Vec3f& position) {
  Strand s;
  if (points.tissueStiffness[k] <= 0) return s;
  const Vec3f l = position - at(around.anchor, k) - time_s * at(around.anchorVelocity, k);
  s.length = l.norm();
  s.extension = s.length - points.tissueRestLength[k];
  if (s.length > 1e-8f) s.direction = l / s.length;
  return s;
}

// The half space of the flesh at a point (Turner & Gobbetti 1998, eq. 13): how far inside, as a
// vector out of it.
inline Vec3f wayOut(const PointSurroundings& around, std::size_t k, float time_s,
                    const Vec3f& position) {
  const Vec3f n = at(around.normal, k);
  const float offset = around.offset[k] + time_s * n.dot(at(around.fleshVelocity, k));
  return std::max(0.f, offset - n.dot(position)) * n;
}

// Velocity after contact: no approach (or the bounce), and friction; relative to the flesh.
inline Vec3f velocityAfterContact(const PointSurroundings& around, std::size_t k,
                                  const ContactResponse& response, float slide,
                                  const Vec3f& velocity) {
  const Vec3f n = at(around.normal, k), flesh = at(around.fleshVelocity, k);
  const Vec3f relative = velocity - flesh;
  const float along = relative.dot(n);
  const float bounced = along < 0 ? -static_cast<float>(response.restitution) * along : along;
  return flesh + bounced * n + slide * (relative - along * n);
}

inline float slideOf(const ContactResponse& response, float step_s) {
  return std::exp(-step_s * static_cast<float>(response.friction_per_s));
}

// Calls visit(k) for every point that is free to move.
template <class Visit>
void forEachFree(const Skin& skin, const Visit& visit) {
  const GridLayout& g = skin.grid()->layout();
  for (int j = 0; j < g.rows; ++j)
    for (std::size_t k = g.row(j); k < g.row(j) + static_cast<std::size_t>(g.columns); ++k)
      if (skin.points().free[k] > 0) visit(k);
}

// Calls visit(k) for every point that moves with a joint.
template <class Visit>
void forEachFixed(const Skin& skin, const Visit& visit) {
  for (const FleshAttachment::Fixed& f : skin.grid()->fixed()) visit(f.point);
}

// Ends a step of a scheme that works with positions only: velocities from the step taken, contact.
inline void finishPositionStep(const Skin& skin, const PointSurroundings& around, float time_s,
                               float step_s, const VectorArray& before, VectorArray& position,
                               VectorArray& velocity) {
  const float slide = slideOf(skin.contactResponse(), step_s);
  forEachFree(skin, [&](std::size_t k) {
    Vec3f r = at(position, k), v = (r - at(before, k)) / step_s;
    const Vec3f out = wayOut(around, k, time_s, r);
    if (out.squaredNorm() > 0) {
      put(position, k, r + out);
      v = velocityAfterContact(around, k, skin.contactResponse(), slide, v);
    }
    put(velocity, k, v);
  });
}

}  // namespace fascia
