#include <fascia/rig/linear_blend.h>

#include <fascia/base/assert.h>

namespace fascia {

LinearBlend::LinearBlend(const RiggedModel& model)
    : weights_(model.weights), rest_(model.points_m), matrices_(model.joints.size()) {}

void LinearBlend::deform(std::span<const Transform> motion, std::span<Eigen::Vector3f> points) {
  FASCIA_ASSERT(!motion.empty(), "joints move");
  for (std::size_t j = 0; j < matrices_.size(); ++j) {
    matrices_[j].setIdentity();
    matrices_[j].topLeftCorner<3, 3>() = motion[j].rotation.cast<float>();
    matrices_[j].topRightCorner<3, 1>() = motion[j].translation_m.cast<float>();
  }
  for (std::size_t p = 0; p < rest_.size(); ++p) {
    Matrix blended = Matrix::Zero();
    for (std::uint32_t i = weights_.first[p]; i < weights_.first[p + 1]; ++i)
      blended += weights_.weight[i] * matrices_[weights_.joint[i]];
    const Eigen::Vector3f& r = rest_[p];
    const Eigen::Vector4f moved =
        blended.col(0) * r.x() + blended.col(1) * r.y() + blended.col(2) * r.z() + blended.col(3);
    points[p] = moved.head<3>();
  }
}

}  // namespace fascia
