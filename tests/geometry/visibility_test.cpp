#include <gtest/gtest.h>

#include <fascia/geometry/visibility.h>

#include "measure/shapes.h"

namespace fascia {
namespace {

double seen(const TriangleMesh& mesh, const std::vector<bool>& chosen, const Vec3& from) {
  return visibleArea(mesh.triangles, mesh.positions, chosen, from.normalized());
}

TEST(VisibleArea, OfABoxIsItsShadow) {
  TriangleMesh mesh;
  addBox(mesh, {0, 0, 0}, {1, 2, 3});
  const std::vector<bool> all(12, true);
  EXPECT_NEAR(seen(mesh, all, {1, 0, 0}), 6, 0.15);
  EXPECT_NEAR(seen(mesh, all, {0, -1, 0}), 3, 0.1);
  const double cornerwise = (2 * 3 + 1 * 3 + 1 * 2) / std::sqrt(3.0);
  EXPECT_NEAR(seen(mesh, all, {1, 1, 1}), cornerwise, 0.02 * cornerwise);
}

TEST(VisibleArea, LeavesOutWhatIsHiddenOrTurnedAway) {
  TriangleMesh mesh;
  addBox(mesh, {0, 0, 0}, {1, 1, 1});
  addBox(mesh, {2, 0, 0}, {3, 1, 0.5});  // hides half of the first, seen along x
  std::vector<bool> first(24, false);
  std::fill_n(first.begin(), 12, true);
  EXPECT_NEAR(seen(mesh, first, {1, 0, 0}), 0.5, 0.02);
  EXPECT_NEAR(seen(mesh, first, {-1, 0, 0}), 1, 0.02);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  // Inside out only the inner sides of the far walls face the viewer, behind the near ones.
  EXPECT_NEAR(seen(mesh, first, {-1, 0, 0}), 0, 1e-9);
  EXPECT_EQ(seen(mesh, std::vector<bool>(24, false), {1, 0, 0}), 0);
}

}  // namespace
}  // namespace fascia
