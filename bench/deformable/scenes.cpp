#include "deformable/scenes.h"

#include <utility>

namespace fascia {
namespace {

// A linear constraint that says it is not: its system is then factored in every step.
class Resolved final : public Constraint {
 public:
  explicit Resolved(ConstraintPtr inner) : Constraint(inner->name()), inner_(std::move(inner)) {}
  std::span<const BodyPoint> points() const override { return inner_->points(); }
  int rowCount(int dimension) const override { return inner_->rowCount(dimension); }
  bool hasConstantJacobian() const override { return false; }
  void evaluate(double t_s, std::span<const Vec3> x, std::span<const Vec3> v,
                ConstraintRows& rows) const override {
    inner_->evaluate(t_s, x, v, rows);
  }

 private:
  ConstraintPtr inner_;
};

// The body that a body hangs on, or -1.
int parentOf(int body, const SceneOptions& options) {
  if (options.layout == Layout::tree) return body == 0 ? -1 : (body - 1) / 3;
  const bool first = options.chainLength > 0 && body % options.chainLength == 0;
  return first ? -1 : body - 1;
}

}  // namespace

BodyShapePtr makeBarShape(const BodyMaterial& material, double density_kg_per_m3) {
  const Box box{-0.5 * kBar_m, 0.5 * kBar_m};
  return std::make_shared<BodyShape>(BodyDef{
      makeAffineBasis(3), boxMatter(3, box, density_kg_per_m3, MatterDetail::of(1)), material});
}

Vec3 barEnd(double side) {
  return {0.5 * side * kBar_m.x(), 0, 0};
}

BodyScene makeScene(const SceneOptions& options) {
  BodyModel model;
  const BodyShapePtr bar = makeBarShape(options.material, kBarDensity_kg_per_m3);
  for (int i = 0; i < options.bodies; ++i) model.add(bar);
  BodyScene scene;
  scene.system =
      std::make_unique<BodySystem>(std::move(model), BodySettings{options.gravity_m_per_s2});
  scene.state = scene.system->model().restState();
  std::vector<Vec3> start(static_cast<std::size_t>(options.bodies));
  int chains = 0;
  for (int i = 0; i < options.bodies; ++i) {
    const int parent = parentOf(i, options);
    Vec3& at = start[static_cast<std::size_t>(i)];
    const BodyPoint begin{BodyId(i), barEnd(-1)};
    ConstraintPtr constraint;
    if (parent < 0) {
      at = Vec3(0, 0, 0.2 * chains++);
      constraint = makeNail("nail", begin, at);
    } else {
      at = start[static_cast<std::size_t>(parent)] + Vec3(kBar_m.x(), 0, 0);
      constraint = makeAttachment("hinge", {BodyId(parent), barEnd(1)}, begin);
    }
    scene.system->model().place(BodyId(i), {Mat3::Identity(), at + barEnd(1)}, scene.state);
    if (!options.constantJacobian) constraint = std::make_shared<Resolved>(constraint);
    scene.system->hold(constraint);
  }
  return scene;
}

}  // namespace fascia
