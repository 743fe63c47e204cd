#pragma once

#include <memory>
#include <span>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/math/types.h>

namespace fascia {

// The flesh and the joints at one moment, and how far morphs have changed the skin itself.
struct SkinPose {
  const Field* field;
  std::span<const Transform> joints;
  std::span<const double> morphs{};  // weights, one each; empty: all at rest
};

// Says where a pose puts what a skin's points are attached to; owns what memory that takes. One per
// run. Each call writes the entries of the points meant, in storage order, and no others.
class PointPlacer {
 public:
  virtual ~PointPlacer() = default;
  // The inner ends of the tissue strands.
  virtual void placeAnchors(const SkinPose& pose, VectorArray& out) = 0;
  // The points that are never simulated. The pose is the one that another of these calls had last.
  virtual void placeFixed(const SkinPose& pose, VectorArray& out) = 0;
  // Every point where the rest shape goes with the pose that placeAnchors had last.
  virtual void placeCarried(const SkinPose& pose, VectorArray& out) = 0;
  // Every point where the rest shape goes with the pose.
  virtual void placeAll(const SkinPose& pose, VectorArray& out) = 0;
};

// What carries the points of a skin. Constant once built.
class SkinAttachment {
 public:
  virtual ~SkinAttachment() = default;
  // The attachment must outlive the placer.
  virtual std::unique_ptr<PointPlacer> makePlacer() const = 0;
};

}  // namespace fascia
