#pragma once

#include <span>
#include <vector>

#include <fascia/contact/slide_energy.h>
#include <fascia/deformable/body/body_model.h>
#include <fascia/math/log_barrier.h>

namespace fascia {

// A point of a body that is near a surface, as one step sees it: the surface is a plane there,
//     gap = gap_m + n · u,   u = s_a Δ_a − s_b Δ_b − drift_m,
// with the ways Δ of the coordinates of both bodies, or the way of an obstacle's matter.
struct Contact {
  struct Side {
    BodyId body;
    std::size_t offset = 0;           // of the body's coordinates
    const double* weights = nullptr;  // s of the point
    int count = 0;                    // of weights
  };
  Side a, b;                    // b.count = 0: an obstacle, which moves by itself
  Vec3 normal = Vec3::UnitY();  // away from b; of unit length, in two dimensions with z = 0
  Vec3 drift_m = Vec3::Zero();
  double gap_m = 0;
  LogBarrier energy;           // of the gap: m, N/m
  double friction = 0;         // µ
  double smoothing_m = 0;      // of friction, in this step
  double inertia_N_per_m = 0;  // what resists a push at the contact, m_eff/h²
};

// All contacts of a step: what they add to the merit of implicit Euler's way, to its gradient and
// to its second derivatives. Allocates when there are more contacts than ever before.
class ContactSet {
 public:
  explicit ContactSet(const BodyModel& model);

  void clear() { contacts_.clear(); }
  void add(const Contact& contact) { contacts_.push_back(contact); }
  void finish();  // after the last one

  bool empty() const { return contacts_.empty(); }
  std::size_t size() const { return contacts_.size(); }
  bool hasPairs() const { return hasPairs_; }             // contacts between bodies
  bool pairsPress() const { return !pressing_.empty(); }  // at the last evaluate()
  const Contact& operator[](std::size_t i) const { return contacts_[i]; }
  double gap_m(std::size_t i) const { return states_[i].gap_m; }
  // The normal force, at the last evaluate() whose loads were `follow`.
  double load_N(std::size_t i) const { return states_[i].load_N; }
  const Vec3& force_N(std::size_t i) const { return states_[i].force_N; }  // on a; −force on b

  // What the normal forces that friction goes by (λ) do at this evaluation.
  enum class Loads {
    bound,   // be those of the present way, but no more than stops the body in this step
    follow,  // be those that the last step along a direction brought about
    keep,    // stay
  };
  void evaluate(std::span<const double> way, Loads loads);
  // As of the last evaluate(): residual += the gradient; matrix += its derivative by the body's own
  // coordinates, of which only the lower triangle is written. For several bodies at once.
  void addGradient(BodyId body, Eigen::Ref<Eigen::VectorXd> residual) const;
  void addCurvature(BodyId body, Eigen::Ref<Eigen::MatrixXd> matrix) const;
  // out += C x with the rest of the derivatives, between bodies.
  void addCoupling(std::span<const double> x, std::span<double> out) const;

  // The merit's part along a search direction, J.
  void setDirection(std::span<const double> direction);
  double merit_J(double step) const;
  void setStep(double step);   // how far along it the way goes on
  double gapEnergy_J() const;  // as of the last evaluate()

 private:
  struct State {
    double gap_m = 0, load_N = 0, mostLoad_N = 0;
    Vec3 slide_m, force_N;   // u, and the force on a
    Mat3 curvature_N_per_m;  // H: the gradient's derivative by u
    double nextLoad_N = 0;   // after it, by the linear equations
    Vec3 directionSlide_m;   // how u changes along the search direction
  };
  struct Entry {
    std::uint32_t contact;
    bool isB;
  };
  void evaluateOne(std::size_t i, std::span<const double> way, Loads loads);
  Vec3 moved(const Contact::Side& side, std::span<const double> x) const;
  std::span<const Entry> entriesOf(BodyId body) const {
    return std::span(entries_).subspan(first_[body.index()],
                                       first_[body.index() + 1] - first_[body.index()]);
  }

  const BodyModel* model_;
  int dimension_;
  bool hasPairs_ = false;
  std::vector<Contact> contacts_;
  std::vector<State> states_;
  std::vector<std::size_t> first_;  // bodyCount + 1: entries of a body
  std::vector<Entry> entries_;
  std::vector<std::size_t> pressing_;  // contacts between bodies that do anything now
};

}  // namespace fascia
