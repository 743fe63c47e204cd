#include <fascia/contact/trace.h>

namespace fascia {
namespace {

constexpr int kMaxSteps = 16;
// Distances of deformed solids are of first order: less than the whole is safe.
constexpr double kShare = 0.8;

}  // namespace

std::optional<Nearness> trace(const DistanceField& field, SolidId solid, const Nearness& start,
                              const Vec3& way, double margin_m) {
  const double length_m = way.norm(), share = kShare / field.lipschitz(solid);
  Nearness near = start;
  double passed_m = 0;
  for (int step = 0; step < kMaxSteps && near.distance_m > margin_m; ++step) {
    passed_m += share * near.distance_m;
    if (passed_m >= length_m) return std::nullopt;
    const Eigen::Vector3f place = (start.place_m + passed_m / length_m * way).cast<float>();
    float distance_m, nx, ny, nz;
    field.evaluate(solid, {&place.x(), &place.y(), &place.z(), 1}, &distance_m, {&nx, &ny, &nz, 1});
    near = {place.cast<double>(), distance_m, Vec3(nx, ny, nz)};
  }
  return near;
}

}  // namespace fascia
