#include <fascia/rig/dual_quaternion.h>

namespace fascia {

DualQuaternionBlend::DualQuaternionBlend(const RiggedModel& model)
    : weights_(model.weights), rest_(model.points_m), motion_(model.joints.size()) {}

void DualQuaternionBlend::deform(std::span<const Transform> motion,
                                 std::span<Eigen::Vector3f> points) {
  for (std::size_t j = 0; j < motion_.size(); ++j) {
    const Quat real(motion[j].rotation);
    const Vec3& t = motion[j].translation_m;
    const Quat dual = Quat(0, t.x(), t.y(), t.z()) * real;
    motion_[j] = {real.coeffs().cast<float>(), 0.5f * dual.coeffs().cast<float>()};
  }
  for (std::size_t p = 0; p < rest_.size(); ++p) {
    // q and -q are the same turn: all are added in the hemisphere of the heaviest (its
    // section 4.1).
    const Eigen::Vector4f pivot = motion_[weights_.joint[weights_.first[p]]].real;
    Eigen::Vector4f real = Eigen::Vector4f::Zero(), dual = Eigen::Vector4f::Zero();
    for (std::uint32_t i = weights_.first[p]; i < weights_.first[p + 1]; ++i) {
      const DualQuaternion& q = motion_[weights_.joint[i]];
      const float weight = q.real.dot(pivot) < 0 ? -weights_.weight[i] : weights_.weight[i];
      real += weight * q.real;
      dual += weight * q.dual;
    }
    const float scale = 1 / real.norm();
    real *= scale;
    dual *= scale;
    // Algorithm 1 there, its last lines: c the real part, d the dual one, vectors and scalars.
    const Eigen::Vector3f c = real.head<3>(), d = dual.head<3>();
    const Eigen::Vector3f& r = rest_[p];
    points[p] =
        r + 2 * c.cross(c.cross(r) + real.w() * r) + 2 * (real.w() * d - dual.w() * c + c.cross(d));
  }
}

}  // namespace fascia
