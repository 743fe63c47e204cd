#pragma once

#include <fascia/skin/mesh/rigged_skin.h>
#include <fascia/skin/skin.h>

namespace fascia {

// An imported mesh that is not simulated: every frame is its pose function, with the jiggle on top.
class PosedSkinRun final : public SkinRun {
 public:
  explicit PosedSkinRun(const Skin& skin) : skin_(skin) {}

  const Skin& skin() const override { return skin_; }
  void advance(SkinPoseSource& poses, double start_s, double end_s, SkinState& state,
               SkinStats& stats) override;

 private:
  Skin skin_;
  RiggedScratch scratch_;
};

}  // namespace fascia
