// Files that other programs wrote, and that were once read wrongly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/fitting/fit_flesh.h>
#include <fascia/io/gltf/gltf_document.h>
#include <fascia/io/rig_import/rig_import.h>

#include "support/assets.h"

namespace fascia {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const JointFit& fitOf(const FleshFit& fit, const std::string& joint) {
  for (const JointFit& one : fit.joints)
    if (one.joint == joint) return one;
  throw std::runtime_error("no joint " + joint);
}

TEST(ForeignFiles, ColladasBindShapeCounts) {
  const auto scaled = caseFile("collada-bind-shape-scale/bindshape2.dae"),
             plain = caseFile("collada-bind-shape-scale/reference.dae");
  if (!scaled || !plain) GTEST_SKIP() << "the files are not here";
  const RiggedModel a = readRiggedModel(scaled->string()), b = readRiggedModel(plain->string());
  EXPECT_NEAR(a.height_m(), 2, 1e-5);
  ASSERT_EQ(a.points_m.size(), b.points_m.size());
  for (std::size_t i = 0; i < a.points_m.size(); ++i)
    EXPECT_LT((a.points_m[i] - b.points_m[i]).norm(), 1e-5f);
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t j = 0; j < a.joints.size(); ++j)
    EXPECT_LT((a.joints[j].rest_world.translation_m - b.joints[j].rest_world.translation_m).norm(),
              1e-5);
}

TEST(ForeignFiles, DracosBoundsAreThoseOfTheUnpackedData) {
  const auto file = caseFile("draco-bounds/draco.glb");
  if (!file) GTEST_SKIP() << "the file is not here";
  const GltfDocument document = GltfDocument::read(file->string());
  const GltfPlace accessors = document.root()["accessors"];
  std::size_t checked = 0;
  for (std::size_t a = 0; a < accessors.size(); ++a) {
    const GltfPlace place = accessors.at(a);
    if (place["type"].text() != "VEC3" || !place["max"]) continue;
    double low[3], high[3];
    place["min"].numbers(low, 3);
    place["max"].numbers(high, 3);
    const std::vector<float> values = document.floats(static_cast<int>(a), 3);
    for (std::size_t c = 0; c < 3; ++c) {
      float least = values[c], most = values[c];
      for (std::size_t i = c; i < values.size(); i += 3) {
        least = std::min(least, values[i]);
        most = std::max(most, values[i]);
      }
      EXPECT_EQ(low[c], static_cast<double>(least)) << a;
      EXPECT_EQ(high[c], static_cast<double>(most)) << a;
    }
    ++checked;
  }
  EXPECT_GT(checked, 0u);
}

TEST(ForeignFiles, DracosWeightsSumToOne) {
  const auto file = caseFile("draco-bounds/draco.glb");
  if (!file) GTEST_SKIP() << "the file is not here";
  const GltfDocument document = GltfDocument::read(file->string());
  const GltfPlace attributes = document.root()["meshes"].at(0)["primitives"].at(0)["attributes"];
  const std::vector<float> weights = document.floats(attributes["WEIGHTS_0"].index(1000), 4);
  for (std::size_t v = 0; v < weights.size(); v += 4)
    EXPECT_NEAR(weights[v] + weights[v + 1] + weights[v + 2] + weights[v + 3], 1, 2e-7);
}

TEST(ForeignFiles, PlaceAndSideOfTheSkinDoNotMatterToFlesh) {
  const auto home = caseFile("off-origin-asymmetry/at0.glb"),
             moved = caseFile("off-origin-asymmetry/off3.glb"),
             turned = caseFile("inside-out-skin/insideout.glb");
  if (!home || !moved || !turned) GTEST_SKIP() << "the files are not here";
  const FleshFit a = fitFlesh(readRiggedModel(home->string())),
                 b = fitFlesh(readRiggedModel(moved->string()));
  EXPECT_EQ(a.flesh.solids.size(), b.flesh.solids.size());
  EXPECT_THAT(b.notes, Not(Contains(HasSubstr("not symmetric"))));
  const RiggedModel out = readRiggedModel(turned->string());
  EXPECT_THAT(out.notes, Contains(HasSubstr("1 of 2 pieces of the mesh are inside out")));
  EXPECT_GT(fitFlesh(out).coverage, 0.99);
}

TEST(ForeignFiles, ClothesDoNotEmptyTheBody) {
  const auto hat = caseFile("hat-empties-head/hat.glb"),
             jacket = caseFile("hat-empties-head/jacket.glb");
  if (!hat || !jacket) GTEST_SKIP() << "the files are not here";
  const FleshFit worn = fitFlesh(readRiggedModel(hat->string()));
  EXPECT_GT(fitOf(worn, "Head").coverage, 0.9);
  EXPECT_THAT(worn.notes, Contains(HasSubstr("('brim', 'cone')")));
  const FleshFit dressed = fitFlesh(readRiggedModel(jacket->string()));
  EXPECT_GT(fitOf(dressed, "Spine").coverage, 0.95);
  EXPECT_LT(fitOf(dressed, "Spine").residual_rms_m, 0.008);
}

}  // namespace
}  // namespace fascia
