// The promise of docs/never-explodes.md, case by case.
#include <gtest/gtest.h>

#include <limits>

#include <fascia/math/ode/integrators.h>

#include "examples.h"
#include "small_character.h"

namespace fascia {
namespace {

using test::Worst;

constexpr double kDeepest_m = 1e-4;  // ε: a tenth of a pixel of a figure that fills a screen
// Of the skin's size, in the frame after the worst jump; an explosion knows no bound.
constexpr double kLongestEdge = 4;
constexpr double kFrames_s[] = {1e-3, 1.0 / 240, 1.0 / 60, 1.0 / 24, 1.0 / 12};

CharacterDef material(double stiffness_N_per_m, double density_kg_per_m2) {
  CharacterDef def = test::smallCharacter();
  SkinMaterialDef& m = def.skin->material;
  m.stretch_u_N_per_m = m.stretch_v_N_per_m = stiffness_N_per_m;
  m.shear_N_per_m = 0.4 * stiffness_N_per_m;
  m.density_kg_per_m2 = density_kg_per_m2;
  return def;
}

void expectSound(const Worst& worst, const std::string& what) {
  EXPECT_TRUE(worst.finite) << what;
  EXPECT_LE(worst.penetration_m, kDeepest_m) << what;
  EXPECT_LE(worst.longestEdge, kLongestEdge) << what;
}

std::string describe(double frame_s, double stiffness, double density) {
  return std::to_string(1e3 * frame_s) + " ms, " + std::to_string(stiffness) + " N/m, " +
         std::to_string(density) + " kg/m2";
}

// Every joint by 90° and the body by 2 m in one frame, back and forth every fifth frame.
class Teleport : public testing::TestWithParam<const char*> {
 protected:
  void runAll(double step_s) {
    for (const double frame : kFrames_s) {
      Worst worst;
      for (const double stiffness : {1.0, 150.0, 1e4, 1e6}) {
        for (const double density : {0.1, 4.0, 100.0}) {
          CharacterDef def = material(stiffness, density);
          def.motions = {test::teleport(5 * frame, 4, kPi / 2, 2)};
          def.simulation.integrator = GetParam();
          def.simulation.step_s = step_s;
          const Worst now = test::simulate(Character(def), 0, frame, 22);
          expectSound(now, describe(frame, stiffness, density));
          worst.add(now);
        }
      }
      RecordProperty(std::to_string(1e3 * frame) + " ms: deepest_um",
                     std::to_string(1e6 * worst.penetration_m));
      RecordProperty(std::to_string(1e3 * frame) + " ms: stretch", std::to_string(worst.stretch));
    }
  }
};

TEST_P(Teleport, IsSurvivedAtEveryFrameRateStiffnessAndDensity) {
  runAll(0);
}

TEST_P(Teleport, IsSurvivedWithStepsAsLongAsFrames) {
  runAll(1.0 / 12);
}

INSTANTIATE_TEST_SUITE_P(NeverExplodes, Teleport, testing::Values("auto", "leapfrog"));

TEST(NeverExplodes, WhenJointsJumpButTheBodyStays) {
  for (const double frame : kFrames_s) {
    for (const double angle : {0.2, 0.8, 1.57}) {
      CharacterDef def = test::smallCharacter();
      def.motions = {test::teleport(5 * frame, 4, angle, 0)};
      expectSound(test::simulate(Character(def), 0, frame, 22), describe(frame, angle, 0));
    }
  }
}

TEST(NeverExplodes, AndComesToRestAgainAfterAJump) {
  for (const double frame : {1.0 / 240, 1.0 / 60, 1.0 / 12}) {
    CharacterDef def = test::smallCharacter();
    def.motions = {test::teleport(5 * frame, 2, kPi / 2, 2)};  // there and back
    const Character character(def);
    const Worst worst = test::simulate(character, 0, frame, static_cast<int>(3 / frame));
    expectSound(worst, describe(frame, 150, 4));
    EXPECT_GT(worst.stretch, def.skin->material.max_stretch);  // pulled as far as it goes, and
    EXPECT_LT(worst.stretch, 1.2 * def.skin->material.max_stretch);  // no farther
    EXPECT_LT(worst.lastStretch, 1.1) << frame;
  }
}

TEST(NeverExplodes, WhenAFineSkinRidesOnACoarseOne) {
  for (const double frame : {1.0 / 240, 1.0 / 12}) {
    for (const double stiffness : {1500.0, 1e6}) {
      CharacterDef def = material(stiffness, 4);
      def.skin->grid.columns = 72, def.skin->grid.rows = 80;
      def.motions = {test::teleport(3 * frame, 2, kPi / 2, 2)};
      const Character character(def);
      ASSERT_NE(character.skin()->coarse(), nullptr);
      expectSound(test::simulate(character, 0, frame, 9), describe(frame, stiffness, 4));
    }
  }
}

TEST(NeverExplodes, WithAnyIntegratorOfTheLibrary) {
  std::vector<std::string> names = {"cloth"};
  for (const IntegratorInfo& integrator : integrators()) names.emplace_back(integrator.name);
  for (const std::string& name : names) {
    for (const double frame : {1.0 / 60, 1.0 / 12}) {
      CharacterDef def = material(150, 4);
      def.skin->grid.columns = def.skin->grid.rows = 8;
      def.motions = {test::teleport(2 * frame, 2, kPi / 2, 2)};
      def.simulation.integrator = name;
      expectSound(test::simulate(Character(def), 0, frame, 6),
                  name + " " + describe(frame, 150, 4));
    }
  }
}

// Of weak drag, Euler swings up at any step that is allowed; so does midpoint at longer ones.
TEST(NeverExplodes, ByRefusingIntegratorsThatCannotBeKeptStable) {
  CharacterDef def = material(1e5, 1);
  def.skin->grid.columns = def.skin->grid.rows = 8;
  def.simulation.min_step_s = 1e-4;
  for (const char* name : {"euler", "rk2"}) {
    def.simulation.integrator = name;
    try {
      const Character built(def);
      ADD_FAILURE() << name << " is taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.issues().front().where.pointer, "/simulation/integrator");
      EXPECT_NE(error.issues().front().message.find(name), std::string::npos);
    }
  }
  for (const char* name : {"auto", "leapfrog", "verlet", "implicit-euler", "rosenbrock4"}) {
    def.simulation.integrator = name;
    EXPECT_NO_THROW(Character{def}) << name;
  }
}

TEST(NeverExplodes, WhenSpunFast) {
  CharacterDef def = test::smallCharacter();
  // Ten turns a second, with the spine bent.
  def.motions = {{"spin", 10, false, {}}};
  def.motions[0].tracks = {test::track("hip", "ry", {{0, 0}, {10, 200 * kPi}}),
                           test::track("spine", "rz", {{0, 0}, {0.3, 1.2}})};
  for (const double frame : kFrames_s)
    expectSound(test::simulate(Character(def), 0, frame, frame < 0.01 ? 120 : 30),
                describe(frame, 0, 0));
}

TEST(NeverExplodes, InAnyGravity) {
  for (const double gravity : {0.0, -9.81, 500.0, -1e4}) {
    for (const double frame : {1.0 / 240, 1.0 / 12}) {
      CharacterDef def = test::smallCharacter();
      def.simulation.gravity_m_per_s2 = Vec3(0.2 * gravity, gravity, 0);
      expectSound(test::simulate(Character(def), 0, frame, 30), describe(frame, 0, gravity));
    }
  }
}

TEST(NeverExplodes, WithExtremeMaterials) {
  for (const double frame : {1.0 / 240, 1.0 / 12}) {
    for (int n = 0; n < 5; ++n) {
      CharacterDef def = test::smallCharacter();
      SkinMaterialDef& m = def.skin->material;
      if (n == 0) m.bending_Nm = 1e3;
      if (n == 1) m.prestretch = 3, m.max_stretch = 4;
      if (n == 2) m.prestretch = 0.5, m.drag_Ns_per_m3 = 1e5;
      if (n == 3) m.drag_Ns_per_m3 = 0, m.friction_per_s = 0, m.restitution = 1;
      if (n == 4) def.skin->tissue = {1e8, 1e6, 0.0};
      expectSound(test::simulate(Character(def), 0, frame, 30),
                  "material " + std::to_string(n) + ", " + describe(frame, 0, 0));
    }
  }
}

// Stiff one way and soft the other, or to shear alone; heavier than its tissue can hold; a thousand
// times the weight.
TEST(NeverExplodes, AtTheEndsOfItsRanges) {
  for (const char* example : {"penguin", "torso", "hippo"}) {
    CharacterDef def =
        test::loadExample(FASCIA_SOURCE_DIR "/examples/" + std::string(example) + ".fascia.json",
                          16, 16)
            .def();
    const int motion = static_cast<int>(def.motions.size()) - 1;
    const auto expect = [&](const CharacterDef& changed, const char* what) {
      expectSound(test::simulate(Character(changed), motion, 1.0 / 60, 12),
                  std::string(example) + ": " + what);
    };
    for (double SkinMaterialDef::*stiffness :
         {&SkinMaterialDef::stretch_u_N_per_m, &SkinMaterialDef::stretch_v_N_per_m,
          &SkinMaterialDef::shear_N_per_m}) {
      CharacterDef changed = def;
      changed.skin->material.*stiffness = 1e6;
      expect(changed, "stiff in one direction");
    }
    CharacterDef heavy = def;
    heavy.skin->material.density_kg_per_m2 = 1000;
    expect(heavy, "heavy");
    CharacterDef pulled = def;
    pulled.simulation.gravity_m_per_s2 = Vec3(0, -1e4, 0);
    expect(pulled, "pulled");
  }
}

// Two capsules end to end: in the crease there is less room than skin.
CharacterDef limb(int columns, int rows, double bend) {
  CharacterDef def;
  def.skeleton.joints.resize(2);
  def.skeleton.joints[0].name = "upper";
  JointDef& elbow = def.skeleton.joints[1];
  elbow.name = "elbow", elbow.parent = "upper";
  elbow.offset_m = Vec3(0, 0.3, 0);
  elbow.dofs = {{Dof::rx, 0, bend}};
  for (const char* joint : {"upper", "elbow"}) {
    FleshSolidDef& solid = def.flesh.solids.emplace_back();
    solid.name = std::string(joint) + " flesh", solid.joint = joint;
    solid.solid = {"capsule", {0.03, 0.12}, {}};
    solid.position_m = Vec3(0, 0.15, 0);
    solid.orientation_rad = Vec3(kPi / 2, 0, 0);
  }
  SkinDef& skin = def.skin.emplace();
  skin.grid.columns = columns, skin.grid.rows = rows;
  skin.grid.bottom = {"upper", Vec3(0, 0.1, 0), Vec3(0, -1, 0), 0};
  skin.grid.top = {"elbow", Vec3(0, 0.2, 0), Vec3(0, 1, 0), 0};
  skin.fat.thickness_m = 0.01;
  skin.contact.self = true;
  def.motions = {{"bend", 2, false, {test::track("elbow", "rx", {{0, 0}, {1, bend}, {2, bend}})}}};
  return def;
}

// Where a rest shape is uneven and folded, bending is stiffer than in a flat sheet.
TEST(NeverExplodes, WhenAnUnevenSkinResistsBending) {
  CharacterDef def =
      test::loadExample(FASCIA_SOURCE_DIR "/examples/torso.fascia.json", 32, 32).def();
  for (const double bending : {0.001, 0.01, 0.1}) {
    def.skin->material.bending_Nm = bending;
    const Worst worst = test::simulate(Character(def), 0, 1.0 / 60, 60);
    expectSound(worst, std::to_string(bending) + " Nm");
    EXPECT_EQ(worst.stats.repaired_points, 0u) << bending;
    EXPECT_LE(worst.stats.max_edge_stretch, 1.2 * def.skin->material.max_stretch + 1e-3) << bending;
  }
}

TEST(NeverExplodes, WhenALimbsSkinMeetsItself) {
  for (const auto& [columns, rows, degrees] :
       {std::tuple{24, 32, 120}, {32, 48, 90}, {48, 96, 60}}) {
    const CharacterDef def = limb(columns, rows, degrees * kPi / 180);
    const Worst worst = test::simulate(Character(def), 0, 1.0 / 60, 120);
    expectSound(worst, std::to_string(degrees));
    EXPECT_LE(worst.stats.max_edge_stretch, 1.2 * def.skin->material.max_stretch + 1e-3) << degrees;
    EXPECT_EQ(worst.stats.repaired_points, 0u) << degrees;
  }
}

TEST(NeverExplodes, WhenTheStateIsBroken) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), huge = 1e30f;
  for (const std::string integrator : {"auto", "leapfrog", "verlet"}) {
    CharacterDef def = test::smallCharacter();
    def.simulation.integrator = integrator;
    const Character character(def);
    const GridLayout& g = character.skin()->grid()->layout();
    const Worst worst =
        test::simulate(character, 0, 1.0 / 60, 12, [&](CharacterState& state, int frame) {
          if (frame == 2) state.skin.position.x[g.at(4, 8)] = nan;
          if (frame == 4) state.skin.velocity.y[g.at(5, 9)] = huge;
          if (frame == 6) state.skin.position.z[g.at(6, 3)] = -huge;
          if (frame == 8) state.skin.velocity.fill(nan);
        });
    expectSound(worst, integrator);
    EXPECT_GT(worst.stats.repaired_points, 0u) << integrator;
  }
}

TEST(NeverExplodes, AndRepairsNothingInAnOrdinaryMotion) {
  const Character character(test::smallCharacter());
  const Worst worst = test::simulate(character, 0, 1.0 / 60, 120);
  expectSound(worst, "sway");
  EXPECT_EQ(worst.stats.repaired_points, 0u);
  EXPECT_LT(worst.stretch, 2.5);
}

}  // namespace
}  // namespace fascia
