#include <Eigen/LU>

#include "solvers/scalar_point.h"

namespace fascia {
namespace {

// Implicit Euler as a minimisation, one point at a time (Chen et al., Vertex Block Descent, 2024):
//   r ← r + H⁻¹ f,  f = −M/h² (r − y) − γ/h (r − r₀) + forces,  y = r₀ + h v + h² g.
// H keeps the positive semi-definite part of each element, as the paper advises for stability. Four
// colours (2 × 2) make the points of a colour independent: they share no edge and no cell.
class BlockDescent final : public Scheme {
 public:
  BlockDescent(const Skin& skin, int passes) : skin_(skin), passes_(passes) {}

  void run(const StepInterval& interval, VectorArray& r, VectorArray& v) override {
    step_s_ = static_cast<float>(interval.duration_s / interval.steps);
    around_ = interval.around;
    for (int s = 1; s <= interval.steps; ++s) {
      time_s_ = static_cast<float>(s) * step_s_;
      before_ = r;
      predict(r, v);
      target_ = r;
      for (int pass = 0; pass < passes_; ++pass)
        for (const int colour : {0, 1, 2, 3}) visitColour(colour % 2, colour / 2, r);
      finishPositionStep(skin_, *around_, time_s_, step_s_, before_, r, v);
    }
  }

 private:
  void predict(VectorArray& r, const VectorArray& v) const {
    const Vec3f fall = step_s_ * gravityOf(skin_);
    forEachFree(skin_, [&](std::size_t k) { put(r, k, at(r, k) + step_s_ * (at(v, k) + fall)); });
    forEachFixed(skin_, [&](std::size_t k) { put(r, k, at(r, k) + step_s_ * at(v, k)); });
  }

  void visitColour(int column, int row, VectorArray& r) const {
    const GridLayout& g = skin_.grid()->layout();
    for (int j = row; j < g.rows; j += 2)
      for (int i = column; i < g.columns; i += 2)
        if (skin_.points().free[g.at(i, j)] > 0) descend(i, j, r);
  }

  struct Local {
    Vec3f f;
    Mat3f h;
  };

  void addEdge(const VectorArray& r, std::size_t self, std::size_t other, float w, float g,
               Local& local) const {
    const float limit = skin_.grid()->elastic().coefficients().cap * g;
    const Vec3f e = at(r, other) - at(r, self);
    const float t = e.squaredNorm() - g, stress = std::clamp(t, -limit, limit);
    local.f += w * stress * e;
    local.h.diagonal().array() += w * std::max(0.f, stress);
    if (std::abs(t) < limit) local.h += 2 * w * e * e.transpose();
  }

  void addCell(const VectorArray& r, const Cell& cell, int corner, Local& local) const {
    const ElasticGrid::Coefficients& c = skin_.grid()->elastic().coefficients();
    const std::size_t k = cell.self;
    const Vec3f d1 = at(r, cell.upRight) - at(r, k), d2 = at(r, cell.right) - at(r, cell.up);
    const Vec3f s1 = 0.5f * (d1 + d2), s2 = 0.5f * (d1 - d2);
    const float t = s1.dot(s2) - c.g12[k];
    const Vec3f gradient = kAlpha[corner] * s2 + kBeta[corner] * s1;
    local.f -= c.w12[k] * std::clamp(t, -c.lim12[k], c.lim12[k]) * gradient;
    if (std::abs(t) < c.lim12[k]) local.h += c.w12[k] * gradient * gradient.transpose();
  }

  void addMembrane(const VectorArray& r, int i, int j, Local& local) const {
    const GridLayout& g = skin_.grid()->layout();
    const ElasticGrid::Coefficients& c = skin_.grid()->elastic().coefficients();
    const int left = g.wrapped(i - 1);
    const std::size_t k = g.at(i, j), l = g.at(left, j), d = g.at(i, j - 1);
    addEdge(r, k, g.at(g.wrapped(i + 1), j), c.w1[k], c.g1[k], local);
    addEdge(r, k, l, c.w1[l], c.g1[l], local);
    addEdge(r, k, g.at(i, j + 1), c.w2[k], c.g2[k], local);
    addEdge(r, k, d, c.w2[d], c.g2[d], local);
    addCell(r, Cell(g, i, j), 0, local);
    addCell(r, Cell(g, left, j), 1, local);
    addCell(r, Cell(g, i, j - 1), 2, local);
    addCell(r, Cell(g, left, j - 1), 3, local);
  }

  void addStrand(const VectorArray& r, std::size_t k, Local& local) const {
    const PointModel& p = skin_.points();
    const Strand s = strandAt(p, *around_, k, time_s_, at(r, k));
    if (s.extension <= 0) return;
    const Vec3f way = at(r, k) - at(before_, k) - step_s_ * at(around_->anchorVelocity, k);
    const float damping = p.tissueDamping[k] / step_s_;
    local.f -= (p.tissueStiffness[k] * s.extension + damping * way.dot(s.direction)) * s.direction;
    const Mat3f along = s.direction * s.direction.transpose();
    const float across = p.tissueStiffness[k] * s.extension / s.length;
    local.h += (p.tissueStiffness[k] + damping - across) * along + across * Mat3f::Identity();
  }

  void descend(int i, int j, VectorArray& r) const {
    const PointModel& p = skin_.points();
    const std::size_t k = skin_.grid()->layout().at(i, j);
    const float inertia = p.mass[k] / (step_s_ * step_s_), drag = p.drag[k] / step_s_;
    const Vec3f here = at(r, k);
    Local local{-inertia * (here - at(target_, k)) - drag * (here - at(before_, k)),
                (inertia + drag) * Mat3f::Identity()};
    addMembrane(r, i, j, local);
    addStrand(r, k, local);
    const Vec3f next = here + local.h.inverse() * local.f;
    put(r, k, next + wayOut(*around_, k, time_s_, next));
  }

  const Skin& skin_;
  int passes_;
  const PointSurroundings* around_ = nullptr;
  VectorArray before_, target_;
  float step_s_ = 0, time_s_ = 0;
};

}  // namespace

std::unique_ptr<Scheme> makeBlockDescent(const Skin& skin, int passes) {
  return std::make_unique<BlockDescent>(skin, passes);
}

}  // namespace fascia
