#include <fascia/skin/mesh/rigged_skin.h>

#include <algorithm>
#include <utility>

namespace fascia {
namespace {

// A pose's joints as the rig's: rest -> now.
void rigMotion(const RiggedSkin& rigged, const SkinPose& pose, std::vector<Transform>& motion) {
  motion.clear();
  for (const RiggedSkin::Joint& j : rigged.joints)
    motion.push_back(pose.joints[j.skeletonJoint] * j.inverseRest);
}

class MeshPlacer final : public PointPlacer {
 public:
  explicit MeshPlacer(const MeshAttachment& attachment) : attachment_(attachment) {
    points_.resize(attachment.sag().size());
  }

  void placeAnchors(const SkinPose& pose, VectorArray& out) override {
    evaluate(pose);
    const VectorArray& sag = attachment_.sag();
    // A strand's inner end lies above its point in the rest posture, and turns with the limb.
    for (std::size_t k = 0; k < attachment_.pointCount(); ++k) {
      const Vector4f turned = scratch_.pose.rotation[k] * Vector4f(sag.x[k], sag.y[k], sag.z[k], 0);
      out.x[k] = points_.x[k] - turned.x();
      out.y[k] = points_.y[k] - turned.y();
      out.z[k] = points_.z[k] - turned.z();
    }
  }
  void placeFixed(const SkinPose&, VectorArray& out) override {
    for (const std::size_t k : attachment_.fixed())
      for (const auto axis : VectorArray::kAxes) (out.*axis)[k] = (points_.*axis)[k];
  }
  void placeAll(const SkinPose& pose, VectorArray& out) override {
    evaluate(pose);
    placeCarried(pose, out);
  }
  void placeCarried(const SkinPose&, VectorArray& out) override {
    for (const auto axis : VectorArray::kAxes)
      std::copy_n((points_.*axis).begin(), attachment_.pointCount(), (out.*axis).begin());
  }

 private:
  void evaluate(const SkinPose& pose) {
    evaluateRigged(attachment_.rigged(), pose, 0, nullptr, scratch_, points_);
  }

  const MeshAttachment& attachment_;
  RiggedScratch scratch_;
  VectorArray points_;  // of the last pose
};

}  // namespace

void evaluateRigged(const RiggedSkin& rigged, const SkinPose& pose, double dt_s,
                    JiggleState* jiggle, RiggedScratch& scratch, VectorArray& out) {
  rigMotion(rigged, pose, scratch.motion);
  PoseObstacles obstacles{pose.field, rigged.fleshSolids};
  rigged.skin->evaluate(scratch.motion, {dt_s, jiggle, &obstacles, pose.morphs}, scratch.pose, out);
  rigged.soft.move(*pose.field, pose.joints, scratch.soft, out);
}

MeshAttachment::MeshAttachment(std::shared_ptr<const RiggedSkin> rigged, VectorArray sag,
                               std::size_t pointCount, std::vector<std::size_t> fixed)
    : rigged_(std::move(rigged)),
      sag_(std::move(sag)),
      pointCount_(pointCount),
      fixed_(std::move(fixed)) {}

std::unique_ptr<PointPlacer> MeshAttachment::makePlacer() const {
  return std::make_unique<MeshPlacer>(*this);
}

}  // namespace fascia
