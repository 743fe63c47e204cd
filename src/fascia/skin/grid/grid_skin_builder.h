#pragma once

#include <span>
#include <string>

#include <fascia/skin/grid/wrap.h>
#include <fascia/skin/skin_parts.h>

namespace fascia {

// Builds a grid skin step by step; each step reads only what the ones before it made.
class GridSkinBuilder {
 public:
  GridSkinBuilder(Skin& skin, const SkinDef& def, const SkinBase& base, std::string pointer,
                  Diagnostics& diagnostics)
      : GridSkinBuilder(skin, def, base, SkinReport(base, std::move(pointer), diagnostics)) {}

  void build();

 private:
  GridSkinBuilder(Skin& skin, const SkinDef& def, const SkinBase& base, const SkinReport& report)
      : skin_(skin), def_(def), base_(base), report_(report) {}
  bool checkGrid() const;
  bool checkPoints() const;
  bool findEnds(EndRing& bottom, EndRing& top);
  void makeRestShape(const EndRing& bottom, const EndRing& top);
  void placeCarriers();
  void setQuantities();
  void attach();
  void measureStrands(std::span<const TissueAnchors::Anchor> anchors);
  void overrideAnchor(int i, int j, TissueAnchors::Anchor& anchor) const;
  void applyEdits();
  void makeModel();
  void fixEnds();
  void makeCoarse();

  GridLayout savedLayout() const { return {def_.points->columns, def_.points->rows, true}; }
  bool sameGrid() const {
    return def_.points->columns == layout_.columns && def_.points->rows == layout_.rows;
  }

  Skin& skin_;
  const SkinDef& def_;
  const SkinBase& base_;
  SkinReport report_;
  GridLayout layout_;
  JointId joint_[2];
};

}  // namespace fascia
