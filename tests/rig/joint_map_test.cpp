#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/rig/joint_map.h>
#include <fascia/rig/joint_meaning.h>

#include "rig/humanoid.h"

namespace fascia {
namespace {

// A tree from "name parent" pairs; the parent -1 starts it.
std::vector<RigJoint> tree(const std::vector<std::pair<std::string, int>>& joints) {
  std::vector<RigJoint> out;
  for (const auto& [name, parent] : joints) out.push_back({name, parent, {}, -1});
  return out;
}

// hips, 2 × spine, neck, head, and on the left: clavicle, upper arm, lower arm, hand, upper leg,
// lower leg, foot, toe; on the right only an arm and a leg, which give the trunk its structure.
std::vector<RigJoint> body(const std::vector<std::string>& n) {
  return tree({{n[0], -1},
               {n[1], 0},
               {n[2], 1},
               {n[3], 2},
               {n[4], 3},
               {n[5], 2},
               {n[6], 5},
               {n[7], 6},
               {n[8], 7},
               {n[9], 0},
               {n[10], 9},
               {n[11], 10},
               {n[12], 11},
               {n[13], 2},
               {n[14], 0}});
}

const std::map<std::string, std::vector<std::string>>& conventions() {
  static const std::map<std::string, std::vector<std::string>> all = {
      {"CMU",
       {"Hips", "Spine", "Spine1", "Neck", "Head", "LeftShoulder", "LeftArm", "LeftForeArm",
        "LeftHand", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase", "RightArm", "RightUpLeg"}},
      {"Mixamo",
       {"mixamorig:Hips", "mixamorig:Spine", "mixamorig:Spine1", "mixamorig:Neck", "mixamorig:Head",
        "mixamorig:LeftShoulder", "mixamorig:LeftArm", "mixamorig:LeftForeArm",
        "mixamorig:LeftHand", "mixamorig:LeftUpLeg", "mixamorig:LeftLeg", "mixamorig:LeftFoot",
        "mixamorig:LeftToeBase", "mixamorig:RightArm", "mixamorig:RightUpLeg"}},
      {"Rigify",
       {"DEF-spine", "DEF-spine.001", "DEF-spine.002", "DEF-spine.004", "DEF-head",
        "DEF-shoulder.L", "DEF-upper_arm.L", "DEF-forearm.L", "DEF-hand.L", "DEF-thigh.L",
        "DEF-shin.L", "DEF-foot.L", "DEF-toe.L", "DEF-upper_arm.R", "DEF-thigh.R"}},
      {"VRM",
       {"J_Bip_C_Hips", "J_Bip_C_Spine", "J_Bip_C_UpperChest", "J_Bip_C_Neck", "J_Bip_C_Head",
        "J_Bip_L_Shoulder", "J_Bip_L_UpperArm", "J_Bip_L_LowerArm", "J_Bip_L_Hand",
        "J_Bip_L_UpperLeg", "J_Bip_L_LowerLeg", "J_Bip_L_Foot", "J_Bip_L_ToeBase",
        "J_Bip_R_UpperArm", "J_Bip_R_UpperLeg"}},
      {"H-Anim",
       {"humanoid_root", "vl5", "vt1", "vc4", "skullbase", "l_sternoclavicular", "l_shoulder",
        "l_elbow", "l_wrist", "l_hip", "l_knee", "l_ankle", "l_metatarsal", "r_shoulder", "r_hip"}},
      {"Unreal",
       {"pelvis", "spine_01", "spine_02", "neck_01", "head", "clavicle_l", "upperarm_l",
        "lowerarm_l", "hand_l", "thigh_l", "calf_l", "foot_l", "ball_l", "upperarm_r", "thigh_r"}},
      {"Daz",
       {"hip", "abdomenLower", "chestUpper", "neckLower", "head", "lCollar", "lShldrBend",
        "lForearmBend", "lHand", "lThighBend", "lShin", "lFoot", "lToe", "rShldrBend",
        "rThighBend"}},
      {"Biped",
       {"Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head",
        "Bip01 L Clavicle", "Bip01 L UpperArm", "Bip01 L Forearm", "Bip01 L Hand", "Bip01 L Thigh",
        "Bip01 L Calf", "Bip01 L Foot", "Bip01 L Toe0", "Bip01 R UpperArm", "Bip01 R Thigh"}},
      {"MakeHuman",
       {"root", "spine02", "spine01", "neck01", "head", "clavicle.L", "upperarm01.L",
        "lowerarm01.L", "wrist.L", "upperleg01.L", "lowerleg01.L", "foot.L", "toe1-1.L",
        "upperarm01.R", "upperleg01.R"}},
      {"numbered",
       {"b_Hip_01", "b_Spine01_02", "b_Spine02_03", "b_Neck_04", "b_Head_05", "b_LeftShoulder_06",
        "b_LeftArm_09", "b_LeftForeArm_010", "b_LeftHand_011", "b_LeftUpLeg_015", "b_LeftLeg_016",
        "b_LeftFoot_017", "b_LeftToe_018", "b_RightArm_020", "b_RightUpLeg_021"}},
      {"suffix",
       {"HipsBone", "SpineBone", "ChestBone", "NeckBone", "HeadBone", "LeftShoulderBone",
        "LeftUpperArmBone", "LeftLowerArmBone", "LeftHandBone", "LeftUpperLegBone",
        "LeftLowerLegBone", "LeftFootBone", "LeftToesBone", "RightUpperArmBone",
        "RightUpperLegBone"}},
      {"joint and its number",
       {"Skeleton_torso_joint_1", "Skeleton_torso_joint_2", "torso_joint_3", "neck_joint_1",
        "neck_joint_2", "arm_joint_L_1", "arm_joint_L_2", "arm_joint_L_3", "arm_joint_L_4",
        "leg_joint_L_1", "leg_joint_L_2", "leg_joint_L_3", "leg_joint_L_4", "arm_joint_R_1",
        "leg_joint_R_1"}},
      {"MikuMikuDance",
       {"下半身", "上半身", "上半身2", "首", "頭", "左肩", "左腕", "左ひじ", "左手首", "左足",
        "左ひざ", "左足首", "左つま先", "右腕", "右足"}},
      {"MikuMikuDance with sides at the end",
       {"腰", "上半身", "上半身２", "首", "頭", "肩.L", "腕.L", "ひじ.L", "手首.L", "足.L",
        "ひざ.L", "足首.L", "つま先.L", "腕.R", "足.R"}},
      {"small letters",
       {"hips", "spine", "chest", "neck", "head", "leftshoulder", "leftupperarm", "leftlowerarm",
        "lefthand", "leftupperleg", "leftlowerleg", "leftfoot", "lefttoes", "rightupperarm",
        "rightupperleg"}}};
  return all;
}

TEST(JointMeaning, IsReadFromEveryConvention) {
  const BodyPart expected[] = {BodyPart::hips,     BodyPart::spine,    BodyPart::spine,
                               BodyPart::neck,     BodyPart::head,     BodyPart::clavicle,
                               BodyPart::upperArm, BodyPart::lowerArm, BodyPart::hand,
                               BodyPart::upperLeg, BodyPart::lowerLeg, BodyPart::foot,
                               BodyPart::toe,      BodyPart::upperArm, BodyPart::upperLeg};
  for (const auto& [convention, names] : conventions()) {
    const std::vector<JointMeaning> meanings = guessMeanings(body(names));
    for (std::size_t j = 0; j < meanings.size(); ++j) {
      const BodySide side = j < 5 ? BodySide::middle : j < 13 ? BodySide::left : BodySide::right;
      EXPECT_EQ(describe(meanings[j]), describe({expected[j], side}))
          << convention << ": " << names[j];
    }
  }
}

TEST(JointMeaning, ReadsNumberedArmsByTheLengthsOfTheirBones) {
  const auto arm = [](std::initializer_list<double> places) {
    std::vector<RigJoint> joints;
    for (const double x : places) {
      const int number = static_cast<int>(joints.size()) + 1;
      RigJoint joint{"arm_" + std::to_string(number) + "_L", number - 2, {}, -1};
      joint.rest_world.translation_m.x() = x;
      joints.push_back(joint);
    }
    std::vector<BodyPart> parts;
    for (const JointMeaning& m : guessMeanings(joints)) parts.push_back(m.part);
    return parts;
  };
  EXPECT_EQ(arm({0.1, 0.4, 0.7}),
            (std::vector{BodyPart::upperArm, BodyPart::lowerArm, BodyPart::hand}));
  EXPECT_EQ(arm({0, 0.1, 0.4}),
            (std::vector{BodyPart::clavicle, BodyPart::upperArm, BodyPart::lowerArm}));
  EXPECT_EQ(arm({0.1, 0.4, 0.7, 0.8}), (std::vector{BodyPart::upperArm, BodyPart::lowerArm,
                                                    BodyPart::hand, BodyPart::unknown}));
}

// Upper and lower body side by side, as MikuMikuDance has them: what holds both is the hips.
TEST(JointMeaning, HipsHoldBothHalvesOfTheBody) {
  const std::vector<JointMeaning> m = guessMeanings(tree({{"センター", -1},
                                                          {"下半身", 0},
                                                          {"左足", 1},
                                                          {"右足", 1},
                                                          {"上半身", 0},
                                                          {"左腕", 4},
                                                          {"右腕", 4},
                                                          {"頭", 4}}));
  EXPECT_EQ(m[0].part, BodyPart::hips);
  EXPECT_EQ(m[1].part, BodyPart::unknown);
  EXPECT_EQ(m[4].part, BodyPart::spine);
}

TEST(JointMeaning, BelievesWhatTheFileSays) {
  const std::vector<RigJoint> joints =
      tree({{"Head", -1}, {"a", 0}, {"b", 1}, {"LeftArm", 1}, {"c", 0}, {"d", 0}});
  const std::vector<std::string> said{"hips", "chest",        "head",
                                      "",     "leftUpperLeg", "leftThumbMetacarpal"};
  const std::vector<JointMeaning> m = guessMeanings(joints, said);
  EXPECT_EQ(m[0].part, BodyPart::hips);
  EXPECT_EQ(m[2].part, BodyPart::head);
  EXPECT_EQ(m[3], JointMeaning{});
  EXPECT_EQ(m[4], (JointMeaning{BodyPart::upperLeg, BodySide::left}));
  EXPECT_EQ(m[5], (JointMeaning{BodyPart::thumb, BodySide::left}));
}

TEST(JointMeaning, LeavesHelpersAlone) {
  for (const char* name : {"LeftArm_twist", "IK_foot.L", "LeftHand_end", "MCH-thigh.L", "Head_tip",
                           "foot_ctrl_l", "hair", "tail_1", "", "___", "42", "l"}) {
    EXPECT_EQ(guessMeanings(tree({{name, -1}}))[0], JointMeaning{}) << name;
  }
}

TEST(JointMeaning, CountsFingersFromTheirThumb) {
  const auto partsOf = [](const std::vector<std::string>& names) {
    std::vector<std::pair<std::string, int>> joints{{"LeftHand", -1}};
    for (const std::string& name : names) joints.emplace_back(name, 0);
    std::vector<BodyPart> parts;
    for (const JointMeaning& m : guessMeanings(tree(joints))) parts.push_back(m.part);
    return parts;
  };
  EXPECT_EQ(partsOf({"finger1-1.L", "finger2-1.L", "finger5-1.L"}),
            (std::vector{BodyPart::hand, BodyPart::thumb, BodyPart::index, BodyPart::pinky}));
  EXPECT_EQ(partsOf({"L Finger0", "L Finger1", "L Finger4"}),
            (std::vector{BodyPart::hand, BodyPart::thumb, BodyPart::index, BodyPart::pinky}));
  EXPECT_EQ(partsOf({"LeftHandThumb1", "f_index.01.L", "J_Bip_L_Little1"}),
            (std::vector{BodyPart::hand, BodyPart::thumb, BodyPart::index, BodyPart::pinky}));
}

std::string sourceOf(const JointMap& map, const std::string& target) {
  for (const JointPair& pair : map) {
    if (pair.target == target) return pair.source;
  }
  return "";
}

TEST(JointMap, PairsEveryConventionWithEveryOther) {
  for (const auto& [from, fromNames] : conventions()) {
    for (const auto& [to, toNames] : conventions()) {
      const JointMap map = guessJointMap(body(fromNames), body(toNames));
      for (std::size_t j = 0; j < toNames.size(); ++j) {
        EXPECT_EQ(sourceOf(map, toNames[j]), fromNames[j]) << from << " to " << to;
      }
    }
  }
}

TEST(JointMap, MatchesTrunksOfDifferentLengthsAtTheChest) {
  Humanoid two, four;
  four.spines = 4;
  const JointMap up = guessJointMap(two.joints(), four.joints());
  EXPECT_EQ(sourceOf(up, "Spine3"), "Spine1");
  EXPECT_EQ(sourceOf(up, "Spine0"), "Spine0");
  const JointMap down = guessJointMap(four.joints(), two.joints());
  EXPECT_EQ(sourceOf(down, "Spine1"), "Spine3");
  EXPECT_EQ(sourceOf(down, "Spine0"), "Spine1");
}

TEST(JointMap, LetsALoneFingerMoveAllFour) {
  const auto source = tree({{"LeftHand", -1}, {"LeftHandIndex1", 0}, {"LThumb", 0}});
  const auto target = tree(
      {{"hand_l", -1}, {"index_01_l", 0}, {"ring_01_l", 0}, {"thumb_01_l", 0}, {"ring_02_l", 2}});
  const JointMap map = guessJointMap(source, target);
  EXPECT_EQ(sourceOf(map, "index_01_l"), "LeftHandIndex1");
  EXPECT_EQ(sourceOf(map, "ring_01_l"), "LeftHandIndex1");
  EXPECT_EQ(sourceOf(map, "thumb_01_l"), "LThumb");
  EXPECT_EQ(sourceOf(map, "ring_02_l"), "");
}

TEST(JointMap, PairsAnyRigWithItselfByName) {
  const auto snake = tree({{"root", -1}, {"tail01", 0}, {"tail02", 1}, {"Kopf", 0}, {"jaw", 3}});
  const JointMap map = guessJointMap(snake, snake);
  ASSERT_EQ(map.size(), snake.size());
  for (const JointPair& pair : map) EXPECT_EQ(pair.source, pair.target);
}

TEST(JointMap, PrefersWhatAPersonGave) {
  const auto joints = Humanoid{}.joints();
  const JointMap given = {{"LeftArm", "RightArm", ""}, {"Head", "", ""}};
  const JointMap map = guessJointMap(joints, joints, given);
  EXPECT_EQ(sourceOf(map, "RightArm"), "LeftArm");
  EXPECT_EQ(sourceOf(map, "LeftArm"), "");
  EXPECT_EQ(sourceOf(map, "Head"), "");
  EXPECT_EQ(sourceOf(map, "Neck"), "Neck");
}

TEST(JointMap, NamesTheNearestJointForAGivenNameThatIsNone) {
  const auto joints = Humanoid{}.joints();
  const JointMap given = {{"LeftForArm", "RightArm", ""}};
  try {
    guessJointMap(joints, joints, given);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'LeftForeArm'?"));
  }
}

TEST(JointMap, NamesEveryGivenNameThatIsNoneWithItsLine) {
  const auto joints = Humanoid{}.joints();
  const JointMap given = parseJointMap("Hat = Head\nHead = Head\n\nScarf = Shawl\n", "j.map");
  try {
    guessJointMap(joints, joints, given);
    FAIL();
  } catch (const Error& error) {
    std::vector<std::pair<int, std::string>> found;
    for (const Issue& issue : error.issues())
      found.emplace_back(issue.where.line, issue.message.substr(0, issue.message.find(',')));
    EXPECT_THAT(found, testing::ElementsAre(std::pair(1, "the joint map names 'Hat'"),
                                            std::pair(4, "the joint map names 'Scarf'"),
                                            std::pair(4, "the joint map names 'Shawl'")));
  }
}

TEST(JointMap, LeavesOutWhatContradictsTheHierarchy) {
  // The source's foot hangs on the hips, beside its leg.
  const auto source = tree({{"Hips", -1}, {"LeftUpLeg", 0}, {"LeftLeg", 1}, {"LeftFoot", 0}});
  const auto target = tree({{"Hips", -1}, {"LeftUpLeg", 0}, {"LeftLeg", 1}, {"LeftFoot", 2}});
  std::vector<std::string> notes;
  const JointMap map = guessJointMap(source, target, {}, &notes);
  EXPECT_EQ(sourceOf(map, "LeftLeg"), "LeftLeg");
  EXPECT_EQ(sourceOf(map, "LeftFoot"), "");
  EXPECT_THAT(notes, testing::ElementsAre(testing::HasSubstr("'LeftFoot' is not driven")));
}

TEST(JointMap, IsPrintedAsTextThatReadsBack) {
  const auto joints = Humanoid{}.joints();
  const JointMap map = guessJointMap(joints, joints);
  const JointMap back = parseJointMap(printJointMap(map), "map.txt");
  ASSERT_EQ(back.size(), map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    EXPECT_EQ(back[i].source, map[i].source);
    EXPECT_EQ(back[i].target, map[i].target);
  }
}

TEST(JointMap, ReadsCommentsEmptyLinesAndNamesWithSpaces) {
  const JointMap map = parseJointMap("# a map\n\n Bip01 L Arm = arm.L # left\nHead =\r\n", "m");
  ASSERT_EQ(map.size(), 2u);
  EXPECT_EQ(map[0].source, "Bip01 L Arm");
  EXPECT_EQ(map[0].target, "arm.L");
  EXPECT_EQ(map[1].source, "Head");
  EXPECT_EQ(map[1].target, "");
}

TEST(JointMap, NamesTheLineThatIsNoPair) {
  try {
    parseJointMap("a = b\nnonsense\n", "map.txt");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("map.txt:2: found 'nonsense'"));
  }
}

}  // namespace
}  // namespace fascia
