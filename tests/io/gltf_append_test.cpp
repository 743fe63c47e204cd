#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include <fascia/io/gltf/gltf_animation.h>
#include <fascia/io/gltf/gltf_builder.h>

namespace fascia {
namespace {

using testing::ElementsAre;

TEST(GltfAppend, NumbersReadBack) {
  GltfDocument document;
  const std::vector<float> floats = {1, 2, 3, -4, 5, 6};
  const std::vector<std::uint8_t> bytes = {1, 2, 3, 250, 5, 6};
  const std::vector<std::uint16_t> shorts = {1, 65535, 3, 4, 5, 6};
  const std::vector<std::uint32_t> large = {0, 70000, 2};
  const int added = document.addFloats(floats, "VEC3", true);
  EXPECT_EQ(document.floats(added, 3), floats);
  EXPECT_THAT(document.integers(document.addBytes(bytes, "VEC3"), 3),
              ElementsAre(1, 2, 3, 250, 5, 6));
  EXPECT_THAT(document.integers(document.addShorts(shorts, "VEC3"), 3),
              ElementsAre(1, 65535, 3, 4, 5, 6));
  EXPECT_EQ(document.integers(document.addIndices(large), 1), large);
  double low[3], high[3];
  const GltfPlace accessors = document.root()["accessors"];
  accessors.at(0)["min"].numbers(low, 3);
  accessors.at(0)["max"].numbers(high, 3);
  EXPECT_THAT(low, ElementsAre(-4, 2, 3));
  EXPECT_THAT(high, ElementsAre(1, 5, 6));
}

TEST(GltfAppend, MostlyZeroVectorsAreSparseAndReadBack) {
  for (const std::size_t count : {3u, 70000u}) {  // indices of 16 bits, and of 32
    GltfDocument document;
    std::vector<float> values(3 * count, 0.0f);
    std::copy_n(std::array{7.f, -8.f, 9.f}.data(), 3, &values[3 * (count - 2)]);
    const int sparse = document.addSparseVectors(values, true);
    EXPECT_EQ(document.floats(sparse, 3), values);
    const GltfPlace accessor = document.root()["accessors"].at(static_cast<std::size_t>(sparse));
    EXPECT_EQ(accessor["sparse"]["count"].count(), 1u);
    double low[3];
    accessor["min"].numbers(low, 3);
    EXPECT_THAT(low, ElementsAre(0, -8, 0));
  }
}

TEST(GltfAppend, ZerosNeedNoDataAndFullVectorsAreNotSparse) {
  GltfDocument document;
  const std::vector<float> zeros(9, 0.0f), full(9, 1.0f);
  EXPECT_EQ(document.floats(document.addSparseVectors(zeros), 3), zeros);
  EXPECT_EQ(document.root()["bufferViews"].size(), 0u);
  const auto dense = static_cast<std::size_t>(document.addSparseVectors(full));
  EXPECT_FALSE(document.root()["accessors"].at(dense)["sparse"]);
}

TEST(GltfAppend, JointsAreBytesWhereTheyFit) {
  GltfDocument document;
  const std::vector<std::uint16_t> small{0, 255, 2, 3}, large{0, 256, 2, 3};
  for (const auto& joints : {small, large}) {
    const int added = document.addJoints(joints);
    EXPECT_EQ(document.integers(added, 4),
              std::vector<std::uint32_t>(joints.begin(), joints.end()));
  }
  const GltfPlace accessors = document.root()["accessors"];
  EXPECT_EQ(accessors.at(0)["componentType"].count(), 5121u);
  EXPECT_EQ(accessors.at(1)["componentType"].count(), 5123u);
}

TEST(GltfBuilder, UsesWhatIsThereAgain) {
  GltfBuilder glb("a.glb");
  const std::vector<float> early{0, 1}, late{0, 2};
  const int first = glb.addTimes(early);
  EXPECT_NE(glb.addTimes(late), first);
  EXPECT_EQ(glb.addTimes(early), first);
  const std::vector<std::uint32_t> front{0, 1, 2}, back{0, 2, 1};
  const int triangles = glb.addIndices(front);
  EXPECT_NE(glb.addIndices(back), triangles);
  EXPECT_EQ(glb.addIndices(front), triangles);
  EXPECT_EQ(glb.document.root()["accessors"].size(), 4u);
}

TEST(GltfBuilder, ShortKeysAreNearAndKeepTheirEnds) {
  GltfBuilder glb("a.glb");
  const std::vector<Eigen::Vector4f> turns{{1, 0, 0, 0}, {0.5f, -0.5f, 0.1f, -0.7f}};
  const std::vector<float> read = glb.document.floats(glb.addShortQuaternions(turns), 4);
  EXPECT_EQ(read[0], 1);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_NEAR(read[i], turns[i / 4][static_cast<Eigen::Index>(i % 4)], 2e-5);
  const std::vector<float> shares{0, 0.3f, 1};
  EXPECT_THAT(glb.document.floats(glb.addShares(shares), 1),
              ElementsAre(0, testing::FloatNear(0.3f, 1e-5f), 1));
}

TEST(GltfBuilder, TracksBecomeSamplersWithTheirChannels) {
  Json animation = Json::Object{{"name", "walk"}};
  EXPECT_FALSE(hasGltfTracks(animation));
  addGltfTrack(animation, 3, 4, 7, "rotation");
  addGltfTrack(animation, 3, 5, 8, "translation");
  ASSERT_TRUE(hasGltfTracks(animation));
  EXPECT_EQ(compactJson(*animation.find("channels")),
            R"([{"sampler":0,"target":{"node":7,"path":"rotation"}},)"
            R"({"sampler":1,"target":{"node":8,"path":"translation"}}])");
  EXPECT_EQ(compactJson(animation.find("samplers")->list()[1]),
            R"({"input":3,"output":5,"interpolation":"LINEAR"})");
}

}  // namespace
}  // namespace fascia
