#include <algorithm>

#include <fascia/deformable/surfaces/body_surface.h>

namespace fascia {
namespace {

class SolidSurface final : public BodySurface {
 public:
  SolidSurface(const Solid& solid, int detail)
      : solid_(solid), mesh_(solid.tessellate(std::max(detail, 3))) {}

  Box bounds_m() const override { return solid_.bounds(); }
  void evaluate(ConstVectors X, float* distance_m, Vectors normal) const override {
    solid_.evaluate(X, distance_m, normal);
  }
  const TriangleMesh& mesh() const override { return mesh_; }

 private:
  Solid solid_;
  TriangleMesh mesh_;
};

}  // namespace

BodySurfacePtr makeSolidSurface(const Solid& solid, int detail) {
  return std::make_shared<SolidSurface>(solid, detail);
}

}  // namespace fascia
