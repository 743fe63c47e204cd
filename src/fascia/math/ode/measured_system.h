#pragma once

#include <chrono>
#include <cstdint>

#include <fascia/math/ode/system.h>

namespace fascia {

// Where the time of a simulation goes.
struct SystemCost {
  std::uint64_t force_evaluations = 0;
  double forces_s = 0, constraints_s = 0;  // wall clock
};

// Passes every call on to another system and notes what it costs: two clock readings a call.
class MeasuredSystem final : public SecondOrderSystem {
 public:
  void wrap(SecondOrderSystem& inner, SystemCost& cost) { inner_ = &inner, cost_ = &cost; }

  std::size_t size() const override { return inner_->size(); }
  std::span<const double> inverseMass() const override { return inner_->inverseMass(); }
  bool hasVelocityForces() const override { return inner_->hasVelocityForces(); }
  bool forcesDependOnTime() const override { return inner_->forcesDependOnTime(); }
  MatrixKind jacobianKind() const override { return inner_->jacobianKind(); }

  void addPositionForces(double t_s, std::span<const double> r, std::span<double> f) override {
    const Timer timer(cost_->forces_s);
    ++cost_->force_evaluations;
    inner_->addPositionForces(t_s, r, f);
  }
  void addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                         std::span<double> f) override {
    const Timer timer(cost_->forces_s);
    inner_->addVelocityForces(t_s, r, v, f);
  }
  bool midpointKick(double t_s, std::span<const double> r, std::span<const double> v, double h_s,
                    std::span<double> out) override {
    const Timer timer(cost_->forces_s);
    const bool kicked = inner_->midpointKick(t_s, r, v, h_s, out);
    cost_->force_evaluations += kicked ? 1 : 0;
    return kicked;
  }
  void forceJacobian(double t_s, std::span<const double> r, std::span<const double> v,
                     SparseMatrix& dfdr, SparseMatrix& dfdv) override {
    const Timer timer(cost_->forces_s);
    inner_->forceJacobian(t_s, r, v, dfdr, dfdv);
  }
  double violation(double t_s, std::span<const double> r) override {
    const Timer timer(cost_->constraints_s);
    return inner_->violation(t_s, r);
  }
  double project(double t_s, std::span<double> r, std::span<double> v) override {
    const Timer timer(cost_->constraints_s);
    return inner_->project(t_s, r, v);
  }

 private:
  using Clock = std::chrono::steady_clock;
  class Timer {
   public:
    explicit Timer(double& total_s) : total_s_(total_s) {}
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    ~Timer() { total_s_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

   private:
    double& total_s_;
    Clock::time_point start_ = Clock::now();
  };

  SecondOrderSystem* inner_ = nullptr;
  SystemCost* cost_ = nullptr;
};

}  // namespace fascia
