#include "solvers/scalar_point.h"

namespace fascia {
namespace {

// Every term of the membrane's energy is ½ C²/α, so it is an XPBD constraint as it stands:
//   edges  C = |e|² − G,       α = 2/w;     cells  C = s1·s2 − G12,  α = 1/w12.
// One Gauss–Seidel pass per step (Macklin et al., Small Steps in Physics Simulation, 2019), so that
// multipliers start at 0: Δλ = −C / (Σ w|∇C|² + α/h²).
class Xpbd final : public Scheme {
 public:
  explicit Xpbd(const Skin& skin)
      : skin_(skin), inverseMass_(skin.grid()->layout().storage(), 0.f) {
    forEachFree(skin, [&](std::size_t k) { inverseMass_[k] = 1 / skin.points().mass[k]; });
  }

  void run(const StepInterval& interval, VectorArray& r, VectorArray& v) override {
    step_s_ = static_cast<float>(interval.duration_s / interval.steps);
    for (int s = 1; s <= interval.steps; ++s) {
      const float time_s = static_cast<float>(s) * step_s_;
      before_ = r;
      predict(r, v);
      solveMembrane(r);
      forEachFree(skin_, [&](std::size_t k) { solveStrand(k, *interval.around, time_s, r); });
      finishPositionStep(skin_, *interval.around, time_s, step_s_, before_, r, v);
    }
  }

 private:
  void predict(VectorArray& r, const VectorArray& v) const {
    const PointModel& p = skin_.points();
    const Vec3f fall = step_s_ * gravityOf(skin_);
    forEachFree(skin_, [&](std::size_t k) {
      const float z = 0.5f * step_s_ * p.drag[k] * inverseMass_[k];
      put(r, k, at(r, k) + step_s_ * ((1 - z) / (1 + z) * at(v, k) + fall));
    });
    forEachFixed(skin_, [&](std::size_t k) { put(r, k, at(r, k) + step_s_ * at(v, k)); });
  }

  // Beyond the stress plateau the multiplier, which is force × h², stays constant.
  static float multiplier(float c, float gradients, float compliance, float limit) {
    const float most = limit * compliance;
    return std::clamp(-c / (gradients + 1 / compliance), -most, most);
  }

  void solveEdge(VectorArray& r, std::size_t a, std::size_t b, float w, float g) const {
    const float masses = inverseMass_[a] + inverseMass_[b];
    if (w <= 0 || masses <= 0) return;
    const Vec3f e = at(r, b) - at(r, a);
    const float squared = e.squaredNorm();
    const float lambda = multiplier(squared - g, 4 * squared * masses, 0.5f * w * step_s_ * step_s_,
                                    skin_.grid()->elastic().coefficients().cap * g);
    put(r, a, at(r, a) - 2 * inverseMass_[a] * lambda * e);
    put(r, b, at(r, b) + 2 * inverseMass_[b] * lambda * e);
  }

  void solveCell(VectorArray& r, const Cell& cell, float w, float g, float limit) const {
    const std::size_t corner[4] = {cell.self, cell.right, cell.up, cell.upRight};
    if (w <= 0) return;
    const Vec3f p[4] = {at(r, corner[0]), at(r, corner[1]), at(r, corner[2]), at(r, corner[3])};
    const Vec3f s1 = 0.5f * (p[1] - p[0] + p[3] - p[2]), s2 = 0.5f * (p[2] - p[0] + p[3] - p[1]);
    Vec3f gradient[4];
    float gradients = 0;
    for (int m = 0; m < 4; ++m) {
      gradient[m] = kAlpha[m] * s2 + kBeta[m] * s1;
      gradients += inverseMass_[corner[m]] * gradient[m].squaredNorm();
    }
    const float lambda = multiplier(s1.dot(s2) - g, gradients, w * step_s_ * step_s_, limit);
    for (int m = 0; m < 4; ++m)
      put(r, corner[m], p[m] + inverseMass_[corner[m]] * lambda * gradient[m]);
  }

  void solveMembrane(VectorArray& r) const {
    const GridLayout& g = skin_.grid()->layout();
    const ElasticGrid::Coefficients& c = skin_.grid()->elastic().coefficients();
    for (int j = 0; j < g.rows; ++j) {
      for (int i = 0; i < g.columns; ++i) {
        const Cell cell(g, i, j);
        const std::size_t k = cell.self;
        solveEdge(r, k, cell.right, c.w1[k], c.g1[k]);
        if (j + 1 == g.rows) continue;
        solveEdge(r, k, cell.up, c.w2[k], c.g2[k]);
        solveCell(r, cell, c.w12[k], c.g12[k], c.lim12[k]);
      }
    }
  }

  // With XPBD's damping: γ = k_d/(k h) resists the way taken along the strand in this step.
  void solveStrand(std::size_t k, const PointSurroundings& around, float time_s,
                   VectorArray& r) const {
    const PointModel& p = skin_.points();
    const Strand s = strandAt(p, around, k, time_s, at(r, k));
    if (s.extension <= 0) return;
    const Vec3f way = at(r, k) - at(before_, k) - step_s_ * at(around.anchorVelocity, k);
    const float gamma = p.tissueDamping[k] / (p.tissueStiffness[k] * step_s_);
    const float compliance = 1 / (p.tissueStiffness[k] * step_s_ * step_s_);
    const float lambda = -(s.extension + gamma * way.dot(s.direction)) /
                         ((1 + gamma) * inverseMass_[k] + compliance);
    put(r, k, at(r, k) + inverseMass_[k] * lambda * s.direction);
  }

  const Skin& skin_;
  FloatArray inverseMass_;
  VectorArray before_;
  float step_s_ = 0;
};

}  // namespace

std::unique_ptr<Scheme> makeXpbd(const Skin& skin) {
  return std::make_unique<Xpbd>(skin);
}

}  // namespace fascia
