#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <fascia/deformable/contact/body_contact.h>
#include <fascia/deformable/solve/body_stepper.h>

#include "bodies.h"

// Bodies that collide, for the tests.
namespace fascia::test {

inline constexpr double kFrame_s = 1.0 / 60;

// A box whose faces are grids of `cells` squares: contacts need points on them.
inline TriangleMesh boxMesh(const Vec3& size_m, int cells = 3) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const double side : {-0.5, 0.5}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (int i = 0; i <= cells; ++i) {
        for (int j = 0; j <= cells; ++j) {
          Vec3 p = side * size_m;
          p[u] = (static_cast<double>(i) / cells - 0.5) * size_m[u];
          p[v] = (static_cast<double>(j) / cells - 0.5) * size_m[v];
          mesh.positions.push_back(p.cast<float>());
        }
      }
      const auto row = static_cast<std::uint32_t>(cells + 1);
      for (std::uint32_t i = 0; i + 1 < row; ++i) {
        for (std::uint32_t j = 0; j + 1 < row; ++j) {
          std::uint32_t a = first + i * row + j, b = a + row, c = b + 1, d = a + 1;
          if (side < 0) std::swap(b, d);
          mesh.triangles.push_back({a, b, c});
          mesh.triangles.push_back({a, c, d});
        }
      }
    }
  }
  computeNormals(mesh.positions, mesh.triangles, mesh.normals);
  return mesh;
}

inline SolidDef sphereDef(double radius_m) {
  return {"sphere", {radius_m}, {}};
}
inline Solid makeSolid(const SolidDef& def) {
  Diagnostics diagnostics;
  Solid solid(def, "/", diagnostics);
  diagnostics.throwIfErrors();
  return solid;
}

struct BoxKind {
  BodyMaterial material{.rigidity_Pa = 1e5, .volume_Pa = 1e5};
  double density_kg_per_m3 = 1000;
  double edge_m = 0.2;
};

// A system of boxes that collide, and its state. Boxes of equal kind share shape and surface.
struct BoxScene {
  std::unique_ptr<BodySystem> system;
  BodyContacts* contacts = nullptr;
  OdeState state;
  std::vector<double> edges_m;

  BoxScene(const std::vector<BoxKind>& kinds, const ContactSettings& settings,
           const Vec3& gravity_m_per_s2 = {0, -9.81, 0}) {
    BodyModel model;
    std::vector<BodySurfacePtr> surfaces;
    BodyShapePtr shape;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const BoxKind& kind = kinds[i];
      const Vec3 size = Vec3::Constant(kind.edge_m);
      const bool again = i > 0 && kinds[i - 1].edge_m == kind.edge_m &&
                         kinds[i - 1].density_kg_per_m3 == kind.density_kg_per_m3 &&
                         kinds[i - 1].material.rigidity_Pa == kind.material.rigidity_Pa;
      if (!again) shape = makeBar(makeAffineBasis(3), kind.material, size, kind.density_kg_per_m3);
      surfaces.push_back(again ? surfaces.back() : makeMeshSurface(boxMesh(size)));
      model.add(shape);
      edges_m.push_back(kind.edge_m);
    }
    system = std::make_unique<BodySystem>(std::move(model), BodySettings{gravity_m_per_s2});
    contacts = &system->setContacts(settings);
    for (std::size_t i = 0; i < kinds.size(); ++i) contacts->setSurface(BodyId(i), surfaces[i]);
    state = system->model().restState();
  }

  void place(int body, const Vec3& center_m, double angle = 0,
             const Vec3& axis = {0.6, 0.48, 0.64}) {
    Transform place{Eigen::AngleAxisd(angle, axis).toRotationMatrix(), center_m};
    system->model().place(BodyId(body), place, state);
  }
  void setVelocity(int body, const Vec3& velocity_m_per_s) {
    const BodyModel& model = system->model();
    model.shape(BodyId(body))
        .setRigidVelocity(model.part(BodyId(body), std::span<const double>(state.r)),
                          {velocity_m_per_s, Vec3::Zero(), Vec3::Zero()},
                          model.part(BodyId(body), std::span<double>(state.v)));
  }
  Vec3 center(int body) const {
    return system->model().point(state.r, {BodyId(body), Vec3::Zero()});
  }
  Vec3 velocity(int body) const {
    return system->model().point(state.v, {BodyId(body), Vec3::Zero()});
  }
  // Of all corners of all boxes: affine boxes have their lowest point at one of them.
  double lowest_m() const {
    double lowest = HUGE_VAL;
    for (std::size_t b = 0; b < edges_m.size(); ++b) {
      for (int c = 0; c < 8; ++c) {
        const Vec3 corner = 0.5 * edges_m[b] * Vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
        lowest = std::min(lowest, system->model().point(state.r, {BodyId(b), corner}).y());
      }
    }
    return lowest;
  }
  double energy_J() const { return system->energy_J(state) + contacts->contacts().gapEnergy_J(); }
};

// One solid that moves without turning.
class MovingSolid : public Field {
 public:
  explicit MovingSolid(const SolidDef& def) : solid_(makeSolid(def)) {}
  Vec3 center_m = Vec3::Zero(), velocity_m_per_s = Vec3::Zero();

  std::size_t solidCount() const override { return 1; }
  Box bounds(SolidId) const override {
    return {solid_.bounds().low + center_m, solid_.bounds().high + center_m};
  }
  void evaluate(SolidId, ConstVectors points, float* distance_m, Vectors normal) const override {
    evaluatePosed(solid_, frame({}), points, distance_m, normal);
  }
  Transform frame(SolidId) const override { return {Mat3::Identity(), center_m}; }
  const Outline& outline(SolidId) const override { return solid_.outline_m(); }
  void velocity(SolidId, ConstVectors points, Vectors velocity) const override {
    const Eigen::Vector3f v = velocity_m_per_s.cast<float>();
    for (std::size_t i = 0; i < points.count; ++i)
      velocity.x[i] = v.x(), velocity.y[i] = v.y(), velocity.z[i] = v.z();
  }
  Vec3 materialFromWorld(SolidId, const Vec3& world) const override {
    return solid_.materialFromLocal(world - center_m);
  }
  Vec3 worldFromMaterial(SolidId, const Vec3& material) const override {
    return solid_.localFromMaterial(material) + center_m;
  }

 private:
  Solid solid_;
};

inline void advance(BodyStepper& stepper, BoxScene& scene, int frames) {
  for (int i = 0; i < frames; ++i) stepper.step(kFrame_s, scene.state);
}

}  // namespace fascia::test
