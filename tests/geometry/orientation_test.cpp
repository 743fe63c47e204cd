#include <fascia/geometry/orientation.h>

#include <gtest/gtest.h>

#include <array>

namespace fascia {
namespace {

struct Pieces {
  TriangleMesh mesh;
  std::vector<std::uint32_t> component;
  std::uint32_t count = 0;

  // A box around a place, counter-clockwise seen from outside or from inside; without its lid, if
  // it is open.
  void addBox(const Vec3& centre, double half_m, bool inward, bool open = false) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k < 8; ++k) {
      const Vec3 corner(k & 1 ? half_m : -half_m, k & 2 ? half_m : -half_m,
                        k & 4 ? half_m : -half_m);
      mesh.positions.push_back((centre + corner).cast<float>());
      component.push_back(count);
    }
    constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {0, 2, 3, 1}, {4, 5, 7, 6}, {2, 6, 7, 3}}};
    for (std::size_t f = 0; f < (open ? 5u : 6u); ++f) {
      const auto& [a, b, c, d] = kFaces[f];
      for (std::array<std::uint32_t, 3> t :
           {std::array<std::uint32_t, 3>{a, b, c}, std::array<std::uint32_t, 3>{a, c, d}}) {
        if (inward) std::swap(t[1], t[2]);
        for (std::uint32_t& corner : t) corner += first;
        mesh.triangles.push_back(t);
      }
    }
    ++count;
  }
  std::vector<std::uint32_t> insideOut() const { return insideOutPieces(mesh, component, count); }
};

using Numbers = std::vector<std::uint32_t>;

TEST(Orientation, FindsWhatIsTurnedInsideOut) {
  Pieces p;
  p.addBox(Vec3(0, 0, 0), 1, false);
  ASSERT_GT(enclosedVolume(p.mesh), 0);  // the box is as it says
  EXPECT_EQ(p.insideOut(), Numbers{});
  p.addBox(Vec3(5, 0, 0), 1, true);
  EXPECT_EQ(p.insideOut(), Numbers{1});
}

TEST(Orientation, LiningsAndCavitiesAreMeantToBeSo) {
  Pieces p;
  p.addBox(Vec3(0, 0, 0), 1, false);
  p.addBox(Vec3(0, 0, 0), 0.8, true);
  EXPECT_EQ(p.insideOut(), Numbers{});
}

TEST(Orientation, WhatLiesWithinGoesWithWhatIsAround) {
  Pieces p;
  p.addBox(Vec3(0, 0, 0), 0.3, true);  // as an eye in a head that was turned as a whole
  p.addBox(Vec3(0, 0, 0), 1, true);
  EXPECT_EQ(p.insideOut(), (Numbers{0, 1}));
}

TEST(Orientation, LeavesBowlsAlone) {
  Pieces p;
  p.addBox(Vec3(0, 0, 0), 1, true);
  p.mesh.triangles.resize(4);  // two of six sides: their areas do not cancel
  p.mesh.triangles.erase(p.mesh.triangles.begin(), p.mesh.triangles.begin() + 2);
  EXPECT_EQ(p.insideOut(), Numbers{});
}

}  // namespace
}  // namespace fascia
