#pragma once

#include <cstddef>
#include <span>

#include <fascia/math/sparse.h>

namespace fascia {

// A mechanical system M r̈ = f(t, r, ṙ) with a diagonal mass matrix, as the integrators see it.
// r and v are flat arrays of scalar coordinates (usually x0 y0 z0 x1 …), metres and m/s.
// Functions may write scratch memory of the system, so they are not const; they must not throw.
class SecondOrderSystem {
 public:
  virtual ~SecondOrderSystem() = default;

  virtual std::size_t size() const = 0;  // number of scalar coordinates
  // 1/kg per coordinate; 0 = driven: the coordinate keeps its velocity, whatever the force.
  virtual std::span<const double> inverseMass() const = 0;

  // Both add to f (newtons).
  virtual void addPositionForces(double t_s, std::span<const double> r, std::span<double> f) = 0;
  virtual void addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                                 std::span<double> f);
  virtual bool hasVelocityForces() const { return false; }
  // What Verlet's step needs of them: writes v⁺ = v + h M⁻¹ f(t, r, ½ (v + v⁺)), f being the whole
  // force. False: the system cannot solve this for v⁺, and Verlet iterates.
  virtual bool midpointKick(double t_s, std::span<const double> r, std::span<const double> v,
                            double h_s, std::span<double> out);
  // True if forces change with t alone (moving anchors): the Rosenbrock solver needs ∂f/∂t then.
  virtual bool forcesDependOnTime() const { return false; }

  // Derivatives of the whole force, size() x size(), row = force. Only implicit solvers ask for
  // them. The default takes 4 size() force evaluations: for small systems and for tests.
  virtual void forceJacobian(double t_s, std::span<const double> r, std::span<const double> v,
                             SparseMatrix& dfdr, SparseMatrix& dfdv);
  // symmetric: both derivatives are; their factorisation then costs less.
  virtual MatrixKind jacobianKind() const { return MatrixKind::general; }

  // How deep the deepest coordinate is inside something it must not enter (m); 0 = feasible.
  virtual double violation(double t_s, std::span<const double> r);
  // Moves r to feasible positions and mends v there; returns the largest component moved (m).
  virtual double project(double t_s, std::span<double> r, std::span<double> v);
};

// f = the whole force.
void evaluateForces(SecondOrderSystem& system, double t_s, std::span<const double> r,
                    std::span<const double> v, std::span<double> f);

}  // namespace fascia
