#include <fascia/skin/point/flesh_attachment.h>

#include <utility>

#include <fascia/math/points.h>

namespace fascia {
namespace {

class FleshPlacer final : public PointPlacer {
 public:
  explicit FleshPlacer(const FleshAttachment& attachment) : attachment_(attachment) {}

  void placeAnchors(const SkinPose& pose, VectorArray& out) override {
    attachment_.anchors().place(*pose.field, scratch_, out);
  }
  void placeFixed(const SkinPose& pose, VectorArray& out) override {
    for (const FleshAttachment::Fixed& f : attachment_.fixed())
      setPoint(out, f.point, pose.joints[f.joint.index()].point(f.position_joint));
  }
  void placeCarried(const SkinPose& pose, VectorArray& out) override { placeAll(pose, out); }
  void placeAll(const SkinPose& pose, VectorArray& out) override {
    attachment_.placements().place(*pose.field, scratch_, out);
    placeFixed(pose, out);
  }

 private:
  const FleshAttachment& attachment_;
  VectorArray scratch_;
};

}  // namespace

FleshAttachment::FleshAttachment(TissueAnchors anchors, TissueAnchors placements,
                                 std::vector<Fixed> fixed)
    : anchors_(std::move(anchors)), placements_(std::move(placements)), fixed_(std::move(fixed)) {}

std::unique_ptr<PointPlacer> FleshAttachment::makePlacer() const {
  return std::make_unique<FleshPlacer>(*this);
}

}  // namespace fascia
