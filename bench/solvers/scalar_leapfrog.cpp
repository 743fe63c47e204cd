#include "solvers/scalar_point.h"

namespace fascia {
namespace {

// The product's stabilised leapfrog once more, without SIMD: what the others' costs are compared
// to.
class ScalarLeapfrog final : public Scheme {
 public:
  explicit ScalarLeapfrog(const Skin& skin)
      : skin_(skin),
        force_(skin.grid()->layout().storage()),
        anchorVelocity_(skin.grid()->layout().storage()) {}

  void run(const StepInterval& interval, VectorArray& r, VectorArray& v) override {
    const double h = interval.duration_s / interval.steps;
    if (std::abs(h - coefficients_.step_s) > 1e-6 * h)
      prepareStep(skin_.points(), skin_.contactResponse(), h, coefficients_);
    carry(*interval.around, v);
    for (int s = 1; s <= interval.steps; ++s) {
      force_.fill(0.f);
      addMembrane(r);
      const auto time_s = static_cast<float>(s * h);
      forEachFree(skin_, [&](std::size_t k) { move(k, *interval.around, time_s, r, v); });
      forEachFixed(skin_,
                   [&](std::size_t k) { put(r, k, at(r, k) + static_cast<float>(h) * at(v, k)); });
    }
  }

 private:
  // Points with added mass take over their share of what their anchor's velocity changed.
  void carry(const PointSurroundings& around, VectorArray& v) {
    forEachFree(skin_, [&](std::size_t k) {
      const Vec3f change = at(around.anchorVelocity, k) - at(anchorVelocity_, k);
      put(v, k, at(v, k) + coefficients_.carry[k] * change);
    });
    anchorVelocity_ = around.anchorVelocity;
  }

  void add(std::size_t k, const Vec3f& f) { put(force_, k, at(force_, k) + f); }

  void addEdge(const VectorArray& r, std::size_t a, std::size_t b, float w, float g) {
    const float cap = skin_.grid()->elastic().coefficients().cap;
    const Vec3f e = at(r, b) - at(r, a);
    const Vec3f f = w * std::clamp(e.squaredNorm() - g, -cap * g, cap * g) * e;
    add(a, f);
    add(b, -f);
  }

  void addMembrane(const VectorArray& r) {
    const GridLayout& g = skin_.grid()->layout();
    const ElasticGrid::Coefficients& c = skin_.grid()->elastic().coefficients();
    for (int j = 0; j < g.rows; ++j) {
      for (int i = 0; i < g.columns; ++i) {
        const Cell cell(g, i, j);
        const std::size_t k = cell.self;
        addEdge(r, k, cell.right, c.w1[k], c.g1[k]);
        if (j + 1 == g.rows) continue;
        addEdge(r, k, cell.up, c.w2[k], c.g2[k]);
        const Vec3f p[4] = {at(r, k), at(r, cell.right), at(r, cell.up), at(r, cell.upRight)};
        const Vec3f s1 = 0.5f * (p[1] - p[0] + p[3] - p[2]);
        const Vec3f s2 = 0.5f * (p[2] - p[0] + p[3] - p[1]);
        const float t = c.w12[k] * std::clamp(s1.dot(s2) - c.g12[k], -c.lim12[k], c.lim12[k]);
        const std::size_t corner[4] = {k, cell.right, cell.up, cell.upRight};
        for (int m = 0; m < 4; ++m) add(corner[m], -t * (kAlpha[m] * s2 + kBeta[m] * s1));
      }
    }
  }

  // As PointStep in skin/point_step-inl.h.
  void move(std::size_t k, const PointSurroundings& around, float time_s, VectorArray& position,
            VectorArray& velocity) const {
    const PointModel& p = skin_.points();
    Vec3f r = at(position, k), v = at(velocity, k);
    const Strand s = strandAt(p, around, k, time_s - coefficients_.step_s, r);
    Vec3f f = at(force_, k) + coefficients_.weight[k] * gravityOf(skin_);
    Vec3f closing = Vec3f::Zero();
    if (s.extension > 0) {
      f -= p.tissueStiffness[k] * s.extension * s.direction;
      const Vec3f relative = v - at(around.anchorVelocity, k);
      closing =
          coefficients_.strandGain[k] *
          (p.tissueRestLength[k] == 0 ? relative : Vec3f(relative.dot(s.direction) * s.direction));
    }
    v = coefficients_.keep[k] * v + coefficients_.gain[k] * f - closing;
    r += coefficients_.step_s * v;
    const Vec3f out = wayOut(around, k, time_s, r);
    if (out.squaredNorm() > 0) {
      r += out;
      v = velocityAfterContact(around, k, skin_.contactResponse(), coefficients_.slide, v);
    }
    put(position, k, r);
    put(velocity, k, v);
  }

  const Skin& skin_;
  StepCoefficients coefficients_;
  VectorArray force_;
  VectorArray anchorVelocity_;  // of the interval before
};

}  // namespace

std::unique_ptr<Scheme> makeScalarLeapfrog(const Skin& skin) {
  return std::make_unique<ScalarLeapfrog>(skin);
}

}  // namespace fascia
