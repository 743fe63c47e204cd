#pragma once

#include <vector>

#include <fascia/skin/point/skin_attachment.h>
#include <fascia/skin/point/tissue.h>

namespace fascia {

// A skin hangs on its flesh: every point on a material point of a solid, but for those that are
// fixed to joints.
class FleshAttachment final : public SkinAttachment {
 public:
  // A point that is fixed to a joint.
  struct Fixed {
    std::size_t point;  // storage index
    JointId joint;
    Vec3 position_joint;
  };
  // `anchors`: the inner ends of the strands; `placements`: the material points that all points of
  // the rest shape go with.
  FleshAttachment(TissueAnchors anchors, TissueAnchors placements, std::vector<Fixed> fixed);

  const TissueAnchors& anchors() const { return anchors_; }
  const TissueAnchors& placements() const { return placements_; }
  const std::vector<Fixed>& fixed() const { return fixed_; }

  std::unique_ptr<PointPlacer> makePlacer() const override;

 private:
  TissueAnchors anchors_, placements_;
  std::vector<Fixed> fixed_;
};

}  // namespace fascia
