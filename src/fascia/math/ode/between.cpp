#include <fascia/math/ode/between.h>

#include <algorithm>

namespace fascia {

void between(const OdeState& from, const OdeState& to, double time_s, OdeState& out) {
  out.resize(to.r.size());
  const double h = to.t_s - from.t_s;
  if (!(h > 0) || time_s >= to.t_s) {
    out = to;
    return;
  }
  const double u = std::max(0.0, (time_s - from.t_s) / h);
  out.t_s = from.t_s + u * h;
  for (std::size_t i = 0; i < from.r.size(); ++i) {
    const double v0 = h * from.v[i], v1 = h * to.v[i], way = to.r[i] - from.r[i];
    const double c = 3 * way - 2 * v0 - v1, d = v0 + v1 - 2 * way;
    out.r[i] = from.r[i] + u * (v0 + u * (c + u * d));
    out.v[i] = (v0 + u * (2 * c + 3 * u * d)) / h;
  }
}

}  // namespace fascia
