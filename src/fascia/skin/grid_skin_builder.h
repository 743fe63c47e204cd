#pragma once

#include <memory>
#include <string>

#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/grid/grid_wrap.h>
#include <fascia/skin/skin_parts.h>

namespace fascia {

// Builds a grid skin step by step; each step reads only what the ones before it made. Parts of the
// skin that it was edited from (`before`, may be nullptr) are taken over where nothing that they
// are made of has changed.
class GridSkinBuilder {
 public:
  GridSkinBuilder(const SkinDef& def, const SkinSettings& settings, const SkinBase& base,
                  const Skin* before, std::string pointer, Diagnostics& diagnostics)
      : GridSkinBuilder(def, settings, base, before,
                        SkinReport(base, std::move(pointer), diagnostics)) {}

  // With errors reported the result must not be used, and may be empty.
  SkinParts build();

 private:
  GridSkinBuilder(const SkinDef& def, const SkinSettings& settings, const SkinBase& base,
                  const Skin* before, const SkinReport& report)
      : def_(def),
        settings_(settings),
        base_(base),
        before_(before ? &before->parts() : nullptr),
        report_(report) {}
  bool checkGrid() const;
  bool checkPoints() const;
  bool findJoints();
  bool findEnds(EndRing (&rings)[2]) const;
  GridRestKey restKey() const;
  bool layAround();
  void layUnder(const GridLayout& fineLayout, const SkinParts& fine);
  void takeOverRest();
  void setRest(std::shared_ptr<const GridWrap> wrap, GridRestKey key, FollowedGrid followed);
  std::shared_ptr<const GridWrap> wrapAnew(const GridWrapKey& key, const EndRing (&ends)[2]) const;
  bool isSaved() const;
  void liftRest(const FaceSamples& faces, GridWrap& wrap) const;
  void wrapFlesh(const EndRing (&ends)[2], GridWrap& wrap) const;
  std::shared_ptr<const SkinFit> fitOf(const VectorArray& tube) const;
  VectorArray savedShape() const;
  void placePoints(GridWrap& wrap) const;
  void attach(GridWrap& wrap) const;
  void overrideAnchors(std::vector<TissueAnchors::Anchor>& anchors) const;
  double sizeOf(const VectorArray& rest) const;  // diagonal of its box
  std::vector<FleshAttachment::Fixed> fixEnds(SkinShape& shape) const;
  void findSource();
  bool keepsQuantity(SkinQuantity quantity) const;
  void setQuantities();
  void applyEdits();
  void makeTopology();
  void makeModel();
  void chooseScheme();
  void makeSelfContact();
  void makeCoarse();

  const VectorArray& rest() const { return parts_.shape->rest; }
  const Transform& jointFrame(int end) const {
    return base_.posedSkeleton.joint_world[joint_[end].index()];
  }
  GridLayout savedLayout() const { return {def_.points->columns, def_.points->rows, true}; }
  bool sameGrid() const {
    return def_.points->columns == layout_.columns && def_.points->rows == layout_.rows;
  }

  const SkinDef& def_;
  const SkinSettings& settings_;
  const SkinBase& base_;
  const SkinParts* before_;
  SkinReport report_;
  GridLayout layout_;
  JointId joint_[2];   // of the bottom and top end
  double size_m_ = 0;  // 0: of the rest shape's own box
  SkinParts parts_;
  std::shared_ptr<const FleshAttachment> attachment_;
  QuantityMask changes_{};  // quantities that are not those of the skin before
  std::shared_ptr<SkinQuantities> quantities_ = std::make_shared<SkinQuantities>();
};

}  // namespace fascia
