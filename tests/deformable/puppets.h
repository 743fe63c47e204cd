#pragma once

#include <memory>

#include <fascia/deformable/puppet/puppet.h>
#include <fascia/deformable/solve/body_stepper.h>

#include "bodies.h"

namespace fascia::test {

// Bars that float apart in a row along x, 1 m each, with strings on them: bar i has the points
// "left i", "middle i" and "right i". There are a place "post" and a place "cart" that moves.
struct PuppetStage {
  static constexpr double kStep_s = 1.0 / 60;

  explicit PuppetStage(int dimension = 3, int bars = 2,
                       BodyScheme scheme = BodyScheme::implicitEuler,
                       const Vec3& gravity = Vec3::Zero()) {
    BodyModel model;
    const auto bar = makeBar(makeAffineBasis(dimension), {.rigidity_Pa = 1e5, .volume_Pa = 1e5},
                             kBarSize_m, 100);
    for (int i = 0; i < bars; ++i) model.add(bar);
    system =
        std::make_unique<BodySystem>(std::move(model), BodySettings{.gravity_m_per_s2 = gravity});
    state = system->model().restState();
    std::vector<NamedPoint> points{{"post", Vec3(0.5, 1, dimension == 3 ? 0.2 : 7)},
                                   {"cart", PointPath(&PuppetStage::cart)}};
    for (int i = 0; i < bars; ++i) {
      system->model().place(BodyId(i), {Mat3::Identity(), Vec3(i, 0, 0)}, state);
      const std::string number = " " + std::to_string(i);
      points.push_back({"left" + number, BodyPoint{BodyId(i), Vec3(-0.2, 0, 0)}});
      points.push_back({"middle" + number, BodyPoint{BodyId(i), Vec3::Zero()}});
      points.push_back({"right" + number, BodyPoint{BodyId(i), Vec3(0.2, 0, 0)}});
    }
    puppet = std::make_unique<Puppet>(*system, state, std::move(points));
    stepper = std::make_unique<BodyStepper>(*system, BodyStepperOptions{.scheme = scheme});
  }

  static PathPoint cart(double t_s) {
    return {Vec3(0.3 * t_s, 0.5, 0), Vec3(0.3, 0, 0), Vec3::Zero()};
  }

  PuppetPointId operator[](const char* name) const { return puppet->find(name); }
  Vec3 position(const char* name) const { return puppet->position_m((*this)[name]); }
  Vec3 velocity(const char* name) const { return puppet->velocity_m_per_s((*this)[name]); }
  void setVelocity(int bar, const Vec3& velocity) {
    Twist twist;
    twist.linear_m_per_s = velocity;
    const BodyId body(bar);
    const BodyModel& model = system->model();
    const std::span<const double> q = state.r;
    model.shape(body).setRigidVelocity(model.part(body, q), twist,
                                       model.part(body, std::span(state.v)));
  }

  void step(double h_s = kStep_s) {
    puppet->update(h_s);
    stepper->step(h_s, state);
  }
  void stepUntil(double t_s, double h_s = kStep_s) {
    while (state.t_s < t_s - 1e-9) step(h_s);
  }

  std::unique_ptr<BodySystem> system;
  OdeState state;
  std::unique_ptr<Puppet> puppet;
  std::unique_ptr<BodyStepper> stepper;
};

}  // namespace fascia::test
