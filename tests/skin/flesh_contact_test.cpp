#include <gtest/gtest.h>

#include <fascia/skin/contact/flesh_contact.h>

#include "support/steep_field.h"
#include "test_fields.h"

namespace fascia {
namespace {

using test::RigidSolids;

// Points all over a box. The skin keeps the distance of its fat from the flesh.
struct Cloud {
  GridLayout layout{37, 40, false};
  PointModel points;
  VectorArray position, velocity;
  double fat_m;
  PointSurroundings around;
  std::vector<PointBlock> blocks;
  FleshContact contact;

  explicit Cloud(double reach_m, double fat = 0.01) : fat_m(fat) {
    for (VectorArray* a : {&position, &velocity}) a->resize(layout.storage());
    around.resize(layout.storage());
    points.fat = test::constant(layout, fat_m);
    points.free = test::constant(layout, 1);
    Random random(61);
    test::forEachPoint(layout, [&](int i, int, std::size_t k) {
      const auto within = [&](double r) {
        return Vec3(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
      };
      test::put(position, k, within(reach_m));
      test::put(velocity, k, within(2));
      if (i % 16 == 0)
        blocks.push_back({k, static_cast<std::uint32_t>(std::min(16, layout.columns - i))});
    });
    contact = FleshContact(blocks);
  }
  FleshContact::Result project(const Field& field, double reach_m = 0.02, double restitution = 0) {
    return contact.project(field, points, static_cast<float>(reach_m),
                           static_cast<float>(restitution), position, velocity, around);
  }
  double deepest(const Field& field) const { return contact.deepest(field, points, position); }
};

struct NamedFlesh {
  const char* name;
  RigidSolids field;
};
std::vector<NamedFlesh> fleshes() {
  const Transform turned{Eigen::AngleAxisd(0.7, Vec3(1, 1, 0).normalized()).matrix(),
                         Vec3(0.02, -0.03, 0.05)};
  return {
      {"one sphere", RigidSolids().addSphere(Vec3::Zero(), 0.3)},
      {"two overlapping spheres",
       RigidSolids().addSphere(Vec3(-0.15, 0, 0), 0.25).addSphere(Vec3(0.12, 0.05, 0), 0.22)},
      {"a sphere inside of another",
       RigidSolids().addSphere(Vec3::Zero(), 0.3).addSphere(Vec3(0.1, 0, 0), 0.1)},
      {"superellipsoid", RigidSolids().add(test::superellipsoid(0.2, 0.3, 0.25, 0.6, 0.8), turned)},
      {"overlapping superellipsoid and sphere",
       RigidSolids()
           .add(test::superellipsoid(0.3, 0.15, 0.2, 0.8, 1), turned)
           .addSphere(Vec3(0, 0.15, 0), 0.2)}};
}

TEST(FleshContact, LeavesNoPointInsideOfAnySolid) {
  for (const NamedFlesh& flesh : fleshes()) {
    Cloud cloud(0.4);
    ASSERT_GT(cloud.deepest(flesh.field), 0.05) << flesh.name;
    const FleshContact::Result result = cloud.project(flesh.field);
    EXPECT_GT(result.maxCorrection_m, 0.05f) << flesh.name;
    EXPECT_LE(cloud.deepest(flesh.field), 1e-5) << flesh.name;
  }
}

// Out of one solid after the other takes hundreds of turns here: planes that meet in an angle of a
// few degrees, so that every way out of the one leads back into the other.
TEST(FleshContact, BringsPointsOutOfNarrowCreases) {
  const RigidSolids flesh = RigidSolids()
                                .addSphere(Vec3(-3.01, 0, 0), 3)
                                .addSphere(Vec3(3.01, 0, 0), 3)
                                .addSphere(Vec3(0, 0.2, 3), 2.8);
  Cloud cloud(0.3, 0.02);
  ASSERT_GT(cloud.deepest(flesh), 0.05);
  cloud.project(flesh);
  EXPECT_LE(cloud.deepest(flesh), 1e-5);
}

// Six spheres close a pocket: no way out of all that touch a point there is a short one.
TEST(FleshContact, BringsPointsOutOfClosedPockets) {
  RigidSolids flesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-0.25, 0.25}) flesh.addSphere(Vec3::Unit(axis) * side, 0.2);
  for (const Vec3& corner : {Vec3(1, 1, 1), Vec3(-1, 1, 1), Vec3(1, -1, 1), Vec3(1, 1, -1),
                             Vec3(-1, -1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, -1)})
    flesh.addSphere(0.15 * corner, 0.2);
  Cloud cloud(0.1, 0.06);
  ASSERT_GT(cloud.deepest(flesh), 0.05);
  cloud.project(flesh);
  EXPECT_LE(cloud.deepest(flesh), 1e-5);
}

// Distances that are right to the first order only, as those of deformed solids are.
class RoughSolids final : public RigidSolids {
 public:
  void evaluate(SolidId id, ConstVectors points, float* distance_m, Vectors normal) const override {
    RigidSolids::evaluate(id, points, distance_m, normal);
    for (std::size_t i = 0; i < points.count; ++i) distance_m[i] += distance_m[i] * distance_m[i];
  }
};

TEST(FleshContact, LooksAgainAfterALongWayOutOfOneSolid) {
  RoughSolids flesh;
  flesh.addSphere(Vec3::Zero(), 0.3);
  Cloud cloud(0.25, 0);
  ASSERT_GT(cloud.deepest(flesh), 0.05);
  cloud.project(flesh);
  EXPECT_LE(cloud.deepest(flesh), 1e-5);
}

TEST(FleshContact, MeasuresTheDepthBelowTheSurfaceOfTheFat) {
  const RigidSolids flesh = RigidSolids().addSphere(Vec3::Zero(), 0.3);
  for (const double fat : {0.0, 0.05}) {
    const Cloud cloud(0.4, fat);
    double expected = 0;
    test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
      expected = std::max(expected, 0.3 + fat - test::at(cloud.position, k).norm());
    });
    EXPECT_NEAR(cloud.deepest(flesh), expected, 1e-6);
  }
}

TEST(FleshContact, DoesNotTouchPointsOutside) {
  for (const NamedFlesh& flesh : fleshes()) {
    Cloud cloud(0.4);
    const Cloud before = cloud;
    cloud.project(flesh.field);
    int outside = 0, moved = 0;
    test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
      const bool same = test::at(cloud.position, k) == test::at(before.position, k) &&
                        test::at(cloud.velocity, k) == test::at(before.velocity, k);
      if (flesh.field.distance(test::at(before.position, k)) > before.fat_m + 1e-6) {
        ++outside;
        EXPECT_TRUE(same) << flesh.name;
      } else {
        moved += !same;
      }
    });
    EXPECT_GT(outside, 100) << flesh.name;
    EXPECT_GT(moved, 50) << flesh.name;
  }
}

// One sphere in motion, and how the cloud lies about it.
struct MovingSphere {
  static constexpr double kRadius_m = 0.3;
  Vec3 center{0.05, -0.02, 0.03};
  Twist twist{Vec3(0.8, -0.5, 0.3), Vec3(1, 4, -2), center};
  RigidSolids field = RigidSolids().addSphere(center, kRadius_m, twist);

  Vec3 radius(const VectorArray& position, std::size_t k) const {
    return test::at(position, k) - center;
  }
  // Below the fat's surface, but not so near to the centre that there is no direction.
  bool inside(const Cloud& cloud, std::size_t k) const {
    const double r = radius(cloud.position, k).norm();
    return r < kRadius_m + cloud.fat_m - 1e-6 && r > 1e-2;
  }
};

TEST(FleshContact, MovesPointsOutOfASphereAlongItsRadiusAndNoFarther) {
  const MovingSphere sphere;
  Cloud cloud(0.4);
  const Cloud before = cloud;
  cloud.project(sphere.field);
  test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
    if (!sphere.inside(before, k)) return;
    const Vec3 out = sphere.radius(before.position, k).normalized();
    const Vec3 expected = (MovingSphere::kRadius_m + cloud.fat_m) * out;
    EXPECT_LT((sphere.radius(cloud.position, k) - expected).norm(), 1e-6);
  });
}

TEST(FleshContact, RemovesTheApproachRelativeToMovingFlesh) {
  const MovingSphere sphere;
  for (const double restitution : {0.0, 0.7}) {
    Cloud cloud(0.4);
    const Cloud before = cloud;
    cloud.project(sphere.field, 0.02, restitution);
    int approaching = 0;
    test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
      if (!sphere.inside(before, k)) return;
      const Vec3 normal = sphere.radius(before.position, k).normalized();
      const Vec3 matter = sphere.twist.at(test::at(cloud.position, k));
      const Vec3 was = test::at(before.velocity, k) - matter;
      const Vec3 is = test::at(cloud.velocity, k) - matter;
      const double along = was.dot(normal);
      EXPECT_NEAR(is.dot(normal), along < 0 ? -restitution * along : along, 1e-5);
      EXPECT_LT((is - is.dot(normal) * normal - was + along * normal).norm(), 1e-5);
      approaching += along < 0;
    });
    EXPECT_GT(approaching, 50);
  }
}

TEST(FleshContact, WritesHalfSpacesThatTouchTheNearestSolid) {
  const MovingSphere sphere;
  constexpr double kReach_m = 0.05;
  Cloud cloud(0.4);
  cloud.project(sphere.field, kReach_m);
  int near = 0, far = 0;
  test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
    const Vec3 normal = test::at(cloud.around.normal, k), skin = test::at(cloud.position, k);
    const double surface = MovingSphere::kRadius_m + cloud.fat_m;
    const double gap = sphere.radius(cloud.position, k).norm() - surface;
    if (gap > kReach_m + 1e-5) {
      ++far;
      EXPECT_EQ(normal.norm(), 0);
    }
    if (gap > kReach_m - 1e-5) return;
    ++near;
    EXPECT_LT((normal - sphere.radius(cloud.position, k).normalized()).norm(), 1e-4);
    EXPECT_NEAR(cloud.around.offset[k], normal.dot(sphere.center) + surface, 2e-6);
    EXPECT_GE(normal.dot(skin), cloud.around.offset[k] - 2e-6);
    EXPECT_LT((test::at(cloud.around.fleshVelocity, k) - sphere.twist.at(skin)).norm(), 1e-5);
  });
  EXPECT_GT(near, 100);
  EXPECT_GT(far, 20);
}

TEST(FleshContact, TakesThePlaneOfTheNearerOfTwoSolids) {
  const RigidSolids flesh =
      RigidSolids().addSphere(Vec3(-0.3, 0, 0), 0.25).addSphere(Vec3(0.3, 0, 0), 0.25);
  Cloud cloud(0.4);
  cloud.project(flesh, 1);
  int sides[2] = {0, 0};
  test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
    const Vec3 p = test::at(cloud.position, k);
    if (std::abs(p.x()) < 0.02) return;
    const Vec3 center(p.x() < 0 ? -0.3 : 0.3, 0, 0);
    EXPECT_GT(test::at(cloud.around.normal, k).dot((p - center).normalized()), 0.9999);
    ++sides[p.x() < 0];
  });
  EXPECT_GT(sides[0], 100);
  EXPECT_GT(sides[1], 100);
}

// A cloud that comes from far away, in steps of `step_m`.
template <class Solids>
void expectMemoryChangesNothing(const Solids& flesh, double step_m) {
  Cloud cloud(0.2);
  for (float& x : cloud.position.x) x += 3.f;
  float farthest_m = 0;
  for (int step = 0; step < 60; ++step) {
    Cloud afresh = cloud;
    afresh.contact = Cloud(0.2).contact;
    const FleshContact::Result result = cloud.project(flesh);
    farthest_m = std::max(farthest_m, result.maxCorrection_m);
    ASSERT_EQ(afresh.project(flesh).maxCorrection_m, result.maxCorrection_m) << step;
    test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
      ASSERT_EQ(test::at(cloud.position, k), test::at(afresh.position, k)) << step;
    });
    for (float& x : cloud.position.x) x -= static_cast<float>(step_m);
  }
  EXPECT_GT(farthest_m, 5e-3f);
}

TEST(FleshContact, RemembersOnlyWhatChangesNothing) {
  RigidSolids chain;
  for (int i = 0; i < 6; ++i) chain.addSphere(Vec3(0.5 * i, 0, 0), 0.1);
  for (const double step_m : {0.01, 0.05}) {
    expectMemoryChangesNothing(chain, step_m);
    expectMemoryChangesNothing(test::Steep<RigidSolids>(chain), step_m);
  }
}

// Blocks are tested many at once, each as if it were alone.
TEST(FleshContact, GivesABlockTheSameBitsWhateverOthersThereAre) {
  for (const NamedFlesh& flesh : fleshes()) {
    Cloud together(0.4), apart = together;
    together.project(flesh.field);
    for (const PointBlock& block : apart.blocks) {
      FleshContact alone(std::span(&block, 1));
      alone.project(flesh.field, apart.points, 0.02f, 0.f, apart.position, apart.velocity,
                    apart.around);
    }
    int moved = 0;
    const Cloud before(0.4);
    test::forEachPoint(together.layout, [&](int, int, std::size_t k) {
      EXPECT_EQ(test::at(together.position, k), test::at(apart.position, k)) << flesh.name;
      EXPECT_EQ(test::at(together.velocity, k), test::at(apart.velocity, k)) << flesh.name;
      EXPECT_EQ(test::at(together.around.normal, k), test::at(apart.around.normal, k));
      moved += test::at(together.position, k) != test::at(before.position, k);
    });
    EXPECT_GT(moved, 50) << flesh.name;
  }
}

TEST(FleshContact, LeavesFixedPointsAlone) {
  const RigidSolids flesh = RigidSolids().addSphere(Vec3::Zero(), 0.3);
  Cloud cloud(0.4);
  cloud.points.free = test::constant(cloud.layout, 0);
  const Cloud before = cloud;
  cloud.project(flesh);
  test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
    EXPECT_EQ(test::at(cloud.position, k), test::at(before.position, k));
    EXPECT_EQ(test::at(cloud.velocity, k), test::at(before.velocity, k));
  });
}

TEST(FleshContact, StaysFiniteAtTheCentreOfASolid) {
  for (const NamedFlesh& flesh : fleshes()) {
    Cloud cloud(0.4, 0);
    for (const RigidSolids::Part& part : flesh.field.parts)
      test::put(cloud.position, cloud.layout.at(5, 7), part.world.translation_m);
    cloud.project(flesh.field);
    test::forEachPoint(cloud.layout, [&](int, int, std::size_t k) {
      EXPECT_TRUE(test::at(cloud.position, k).allFinite());
      EXPECT_TRUE(test::at(cloud.around.normal, k).allFinite());
    });
    EXPECT_LE(cloud.deepest(flesh.field), 1e-5) << flesh.name;
  }
}

}  // namespace
}  // namespace fascia
