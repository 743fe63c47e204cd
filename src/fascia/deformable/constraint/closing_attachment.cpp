#include <fascia/deformable/constraint/closing_attachment.h>

#include <array>
#include <utility>

namespace fascia {
namespace {

class ClosingAttachment final : public Constraint {
 public:
  ClosingAttachment(std::string name, const BodyPoint& a, const BodyPoint& b,
                    const CubicSegment& gap)
      : Constraint(std::move(name)), points_{a, b}, gap_(gap) {}
  std::span<const BodyPoint> points() const override { return points_; }
  int rowCount(int dimension) const override { return dimension; }
  bool hasConstantJacobian() const override { return true; }
  void evaluate(double t_s, std::span<const Vec3> x, std::span<const Vec3>,
                ConstraintRows& rows) const override {
    const PathPoint gap = gap_.at(t_s);
    rows.value = x[0] - x[1] - gap.position_m;
    rows.rate_m_per_s = -gap.velocity_m_per_s;
    rows.acceleration_m_per_s2 = -gap.acceleration_m_per_s2;
    if (rows.jacobian.empty()) return;
    rows.jacobian[0] = Mat3::Identity();
    rows.jacobian[1] = -Mat3::Identity();
  }

 private:
  std::array<BodyPoint, 2> points_;
  CubicSegment gap_;
};

}  // namespace

ConstraintPtr makeClosingAttachment(std::string name, const BodyPoint& a, const BodyPoint& b,
                                    const CubicSegment& gap) {
  return std::make_shared<ClosingAttachment>(std::move(name), a, b, gap);
}

PointPath pathBeside(PointPath path, const CubicSegment& gap) {
  return [path = std::move(path), gap](double t_s) {
    const PathPoint n = path(t_s), beside = gap.at(t_s);
    return PathPoint{n.position_m + beside.position_m, n.velocity_m_per_s + beside.velocity_m_per_s,
                     n.acceleration_m_per_s2 + beside.acceleration_m_per_s2};
  };
}

}  // namespace fascia
