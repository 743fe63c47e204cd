#include <fascia/pose/shell_nesting.h>

#include <gtest/gtest.h>

#include "pose/limb.h"

namespace fascia {
namespace {

using test::Limb;
using test::posed;

// A limb whose skin is cut into panels: what lies on the one side of a plane along it, before the
// joint or behind it, has points of its own.
struct PanelLimb : Limb {
  std::vector<std::uint32_t> copyOf;  // per point

  PanelLimb() {
    const auto panelOf = [&](const std::array<std::uint32_t, 3>& t) {
      const Eigen::Vector3f middle = (points[t[0]] + points[t[1]] + points[t[2]]) / 3;
      return (middle.z() > 0.012f ? 1u : 0u) + (middle.x() > 0.31f ? 2u : 0u);
    };
    const auto whole = static_cast<std::uint32_t>(points.size());
    std::vector<std::array<std::uint32_t, 4>> inPanel(whole, {~0u, ~0u, ~0u, ~0u});
    std::vector<Eigen::Vector3f> cutPoints;
    std::vector<PointWeights> cutWeights;
    for (auto& t : triangles) {
      const std::uint32_t panel = panelOf(t);
      for (std::uint32_t& i : t) {
        std::uint32_t& own = inPanel[i][panel];
        if (own == ~0u) {
          own = static_cast<std::uint32_t>(cutPoints.size());
          cutPoints.push_back(points[i]);
          cutWeights.push_back(weights[i]);
          copyOf.push_back(i);
        }
        i = own;
      }
    }
    points = cutPoints;
    weights = cutWeights;
  }
  // The widest gap between points that coincide at rest.
  float gap(std::span<const Eigen::Vector3f> now) const {
    std::vector<int> first(points.size(), -1);
    float widest = 0;
    for (std::size_t i = 0; i < copyOf.size(); ++i) {
      int& other = first[copyOf[i]];
      if (other < 0)
        other = static_cast<int>(i);
      else
        widest = std::max(widest, (now[i] - now[static_cast<std::size_t>(other)]).norm());
    }
    return widest;
  }
};

TEST(ShellNesting, PanelsThatCoincideStayTogetherInABend) {
  const PanelLimb limb;
  const std::vector<Eigen::Vector3f> bent = posed(limb.skin(), limb.turned(1.8));
  EXPECT_GT(test::farthest(bent, limb.points), 0.2f);
  EXPECT_LT(limb.gap(bent), 1e-5f);
}

TEST(ShellNesting, KeepsTheRestPose) {
  const PanelLimb limb;
  EXPECT_LT(test::farthest(posed(limb.skin(), limb.turned(0)), limb.points), 1e-6f);
}

TEST(ShellNesting, RigidPanelsStayOnTheirBone) {
  const PanelLimb limb;
  PoseDials dials;
  dials.rigid.assign(limb.points.size(), 1);
  const std::vector<Eigen::Vector3f> bent = posed(limb.skin(dials), limb.turned(0.5));
  const PoseMesh mesh = makePoseMesh(limb.source());
  EXPECT_EQ(ShellNesting(limb.source(), mesh, dials.rigid).pointCount(), 0u);
  EXPECT_LT(limb.gap(bent), 1e-5f);
}

TEST(ShellNesting, LeavesAFigureOfOneSkinAlone) {
  const Limb limb;
  const PoseMesh mesh = makePoseMesh(limb.source());
  const std::vector<char> soft(limb.points.size(), 0);
  EXPECT_EQ(ShellNesting(limb.source(), mesh, soft).pointCount(), 0u);
}

}  // namespace
}  // namespace fascia
