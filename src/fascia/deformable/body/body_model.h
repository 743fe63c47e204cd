#pragma once

#include <memory>
#include <span>
#include <vector>

#include <fascia/deformable/body/body.h>
#include <fascia/deformable/constraint/constraint.h>
#include <fascia/math/ode/integrator.h>

namespace fascia {

using BodyShapePtr = std::shared_ptr<const BodyShape>;

// The bodies of a system and where each has its coordinates in the system's q (§3.1: the global
// state is the concatenation of the objects'). State is an OdeState: r = q and v = q̇ of all bodies.
class BodyModel {
 public:
  // Throws Error unless all bodies have one dimension.
  BodyId add(BodyShapePtr shape);

  int dimension() const { return shapes_.empty() ? 3 : shapes_.front()->dimension(); }
  std::size_t bodyCount() const { return shapes_.size(); }
  std::size_t size() const { return size_; }  // coordinates of all bodies
  const BodyShape& shape(BodyId body) const { return *shapes_[body.index()]; }
  const BodyShapePtr& sharedShape(BodyId body) const { return shapes_[body.index()]; }
  std::size_t offset(BodyId body) const { return offsets_[body.index()]; }
  bool contains(BodyId body) const { return body.valid() && body.index() < shapes_.size(); }

  // The body's part of an array of all coordinates.
  std::span<const double> part(BodyId body, std::span<const double> all) const {
    return all.subspan(offset(body), static_cast<std::size_t>(shape(body).coordinateCount()));
  }
  std::span<double> part(BodyId body, std::span<double> all) const {
    return all.subspan(offset(body), static_cast<std::size_t>(shape(body).coordinateCount()));
  }

  Vec3 point(std::span<const double> q, const BodyPoint& p) const {
    return shape(p.body).point(part(p.body, q), p.X_m);
  }

  OdeState restState() const;  // all bodies undeformed, where they were made
  void place(BodyId body, const Transform& place, OdeState& state) const;

  double kineticEnergy_J(std::span<const double> v) const;
  double elasticEnergy_J(std::span<const double> q) const;
  Vec3 momentum_Ns(std::span<const double> v) const;
  Vec3 angularMomentum_Nms(std::span<const double> q, std::span<const double> v) const;

 private:
  std::vector<BodyShapePtr> shapes_;
  std::vector<std::size_t> offsets_;
  std::size_t size_ = 0;
};

}  // namespace fascia
