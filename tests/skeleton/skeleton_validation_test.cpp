#include <limits>
#include <string>

#include <fascia/base/suggest.h>
#include <fascia/skeleton/skeleton.h>
#include <fascia/skeleton/skeleton_validation.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fascia {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

SkeletonDef chain() {
  SkeletonDef def;
  def.joints = {{"shoulder", "", Vec3::Zero(), Vec3::Zero(), {{Dof::rx, -1, 1, 0}}},
                {"elbow", "shoulder", Vec3(0.3, 0, 0), Vec3::Zero(), {{Dof::rz, 0, 2.5, 0.1}}},
                {"hand", "elbow", Vec3(0.25, 0, 0), Vec3::Zero(), {}}};
  return def;
}

std::vector<Issue> errors(const SkeletonDef& def) {
  Diagnostics diagnostics;
  const Skeleton skeleton(def, "/skeleton", diagnostics);
  return diagnostics.errors();
}

std::vector<std::string> pointers(const SkeletonDef& def) {
  std::vector<std::string> found;
  for (const Issue& issue : errors(def)) found.push_back(issue.where.pointer);
  return found;
}

TEST(SkeletonValidation, AcceptsAChain) {
  EXPECT_THAT(pointers(chain()), IsEmpty());
}

TEST(SkeletonValidation, RefusesNoJointsAndTooMany) {
  EXPECT_THAT(pointers({}), ElementsAre("/skeleton"));
  SkeletonDef many;
  many.joints.resize(kMostJoints + 1);
  EXPECT_THAT(pointers(many), ElementsAre("/skeleton"));
}

TEST(SkeletonValidation, RefusesMissingAndDuplicateNames) {
  SkeletonDef def = chain();
  def.joints.push_back({"elbow", "hand", {}, {}, {}});
  def.joints.push_back({"", "hand", {}, {}, {}});
  def.joints[3].offset_m = def.joints[3].orientation_rad = Vec3::Zero();
  def.joints[4].offset_m = def.joints[4].orientation_rad = Vec3::Zero();
  EXPECT_THAT(pointers(def), ElementsAre("/skeleton/3/name", "/skeleton/4/name"));
}

TEST(SkeletonValidation, UnknownParentGetsTheNearestName) {
  SkeletonDef def = chain();
  def.joints[2].parent = "elbo";
  const std::vector<Issue> found = errors(def);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where.pointer, "/skeleton/2/parent");
  EXPECT_EQ(found[0].message, "unknown joint 'elbo'");
  EXPECT_EQ(found[0].hint, "did you mean 'elbow'?");
}

TEST(SkeletonValidation, RefusesCircularParents) {
  SkeletonDef self = chain();
  self.joints[2].parent = "hand";
  ASSERT_THAT(pointers(self), ElementsAre("/skeleton/2/parent"));
  EXPECT_THAT(errors(self)[0].message, HasSubstr("'hand' → 'hand'"));
  SkeletonDef pair = chain();
  pair.joints[1].parent = "hand";
  ASSERT_THAT(pointers(pair), ElementsAre("/skeleton/1/parent"));
  EXPECT_THAT(errors(pair)[0].message, HasSubstr("'elbow' → 'hand' → 'elbow'"));
}

TEST(SkeletonValidation, RefusesAParentThatComesLater) {
  SkeletonDef def = chain();
  std::swap(def.joints[1], def.joints[2]);
  ASSERT_THAT(pointers(def), ElementsAre("/skeleton/1/parent"));
  EXPECT_THAT(errors(def)[0].message, HasSubstr("comes later"));
}

TEST(SkeletonValidation, RefusesNoRootAndSeveral) {
  SkeletonDef none = chain();
  none.joints[0].parent = "hand";
  EXPECT_THAT(pointers(none), ElementsAre("/skeleton/0/parent", "/skeleton"));
  SkeletonDef two = chain();
  two.joints[2].parent = "";
  ASSERT_THAT(pointers(two), ElementsAre("/skeleton/2/parent"));
  EXPECT_THAT(errors(two)[0].message, HasSubstr("second root"));
}

TEST(SkeletonValidation, RefusesNumbersThatAreNotFiniteOrAbsurd) {
  for (double bad : {kNaN, kInfinity, -kInfinity, 2e6}) {
    SkeletonDef def = chain();
    def.joints[1].offset_m.y() = bad;
    def.joints[2].orientation_rad.z() = bad;
    def.joints[0].dofs[0] = {Dof::rx, -1e9, 1e9, bad};
    EXPECT_THAT(pointers(def), ElementsAre("/skeleton/0/dofs/rx/rest_deg", "/skeleton/1/offset_m/1",
                                           "/skeleton/2/orientation_deg/2"));
  }
  for (double bad : {kNaN, kInfinity}) {
    SkeletonDef def = chain();
    def.joints[0].dofs[0].max = bad;
    def.joints[1].dofs[0].min = -bad;
    EXPECT_THAT(pointers(def),
                ElementsAre("/skeleton/0/dofs/rx/max_deg", "/skeleton/1/dofs/rz/min_deg"));
  }
}

TEST(SkeletonValidation, RefusesBadLimitsAndDuplicateDofs) {
  SkeletonDef def = chain();
  def.joints[0].dofs = {{Dof::rx, 1, -1, 0}, {Dof::ty, 0, 1, 2}, {Dof::ty, 0, 1, 0}};
  EXPECT_THAT(pointers(def),
              ElementsAre("/skeleton/0/dofs/rx", "/skeleton/0/dofs/ty", "/skeleton/0/dofs/ty"));
}

TEST(SkeletonValidation, LongCirclesEndQuickly) {
  SkeletonDef def;
  for (std::size_t i = 0; i < kMostJoints; ++i) {
    JointDef joint;
    joint.name = std::to_string(i);
    joint.parent = std::to_string((i + 1) % kMostJoints);
    def.joints.push_back(joint);
  }
  EXPECT_EQ(errors(def).size(), kMostJoints);  // all but the last, and the missing root
}

TEST(NearestName, FindsSlipsButNotStrangers) {
  const auto nearest = [](std::string_view found) {
    NearestName name(found);
    for (const char* known : {"elbow", "hand", "left_knee", "right_knee"}) name.offer(known);
    return name.best();
  };
  EXPECT_EQ(nearest("elbo"), "elbow");   // one missing
  EXPECT_EQ(nearest("elbwo"), "elbow");  // two swapped
  EXPECT_EQ(nearest("Hand"), "hand");    // one replaced
  EXPECT_EQ(nearest("leftknee"), "left_knee");
  EXPECT_EQ(nearest("tail"), "");
  EXPECT_EQ(nearest(""), "");
  EXPECT_EQ(nearest(std::string(1000, 'x')), "");
}

TEST(Quoted, MakesHostileNamesHarmless) {
  EXPECT_EQ(quotedName("arm"), "'arm'");
  EXPECT_EQ(quotedName("a\x1b[31m\n"), "'a?[31m?'");
  const std::string longName(100000, 'x');
  EXPECT_LT(quotedName(std::string_view(longName)).size(), 80u);
}

}  // namespace
}  // namespace fascia
