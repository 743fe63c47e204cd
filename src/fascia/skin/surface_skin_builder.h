#pragma once

#include <memory>
#include <string>
#include <vector>

#include <fascia/skin/point/flesh_attachment.h>
#include <fascia/skin/skin_parts.h>
#include <fascia/skin/surface/surface_rest.h>

namespace fascia {

// Builds a skin on triangles around the surface of its solids, step by step; each step reads only
// what the ones before it made. Points hang on their solids as those of a grid do, but none is
// fixed to a joint. Parts of the skin that it was edited from (`before`, of this kind; may be
// nullptr) are taken over where nothing that they are made of has changed.
class SurfaceSkinBuilder {
 public:
  SurfaceSkinBuilder(const SkinDef& def, const SkinBase& base, const Skin* before,
                     std::string pointer, Diagnostics& diagnostics)
      : def_(def),
        base_(base),
        before_(before ? &before->parts() : nullptr),
        report_(base, std::move(pointer), diagnostics) {}

  // With errors reported the result must not be used, and may be empty.
  SkinParts build();

 private:
  bool checkDef() const;
  bool checkPoints() const;
  SurfaceRestKey restKey() const;
  bool lay();
  std::vector<std::uint32_t> setShape(const TriangleMesh& mesh);
  void sampleBetweenPoints();
  void attach();
  void drape(const TriangleMesh& mesh, const std::vector<std::uint32_t>& order);
  void setQuantities();
  void applyEdits();
  void makeTopology();
  void makeModel();
  void layFat();

  std::size_t count() const { return rest_->solid.size(); }
  const VectorArray& restShape() const { return parts_.shape->rest; }

  const SkinDef& def_;
  const SkinBase& base_;
  const SkinParts* before_;
  SkinReport report_;
  std::shared_ptr<const SurfaceRest> rest_;
  std::shared_ptr<SurfaceRest> making_;  // the same while it is made
  std::shared_ptr<const FleshAttachment> attachment_;
  std::shared_ptr<SkinQuantities> quantities_ = std::make_shared<SkinQuantities>();
  SkinParts parts_;
};

}  // namespace fascia
