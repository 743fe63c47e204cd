#include <fascia/io/gltf/gltf_document.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <fascia/io/file/file.h>
#include <fascia/io/rig_import/gltf/rig_from_gltf.h>

#include "gltf_sample.h"
#include "sample.h"
#include "support/assets.h"

namespace fascia {
namespace {

using sample::TinyGltf;
using sample::TubeRig;
using testing::ElementsAre;
using testing::HasSubstr;

GltfDocument parsed(const TinyGltf& file) {
  return GltfDocument::parse(file.glb(), "sample.glb");
}

// The message of the Error that reading throws; empty if it throws none.
std::string complaint(const std::string& bytes) {
  try {
    GltfDocument::parse(bytes, "sample.glb");
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}
template <class Read>
std::string complaintOf(const Read& read) {
  try {
    read();
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

void save(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(GltfAccessors, ResolveEveryComponentType) {
  TinyGltf file;
  file.add<std::int8_t>({-128, 127, 5, 0}, 1, "SCALAR");
  file.add<std::uint8_t>({0, 255, 7, 1}, 1, "SCALAR");
  file.add<std::int16_t>({-32768, 32767}, 1, "SCALAR");
  file.add<std::uint16_t>({0, 65535}, 1, "SCALAR");
  file.add<std::uint32_t>({0, 4000000000u}, 1, "SCALAR");
  file.add<float>({-1.5f, 1e30f}, 1, "SCALAR");
  const GltfDocument document = parsed(file);
  EXPECT_THAT(document.floats(0, 1), ElementsAre(-128, 127, 5, 0));
  EXPECT_THAT(document.floats(1, 1), ElementsAre(0, 255, 7, 1));
  EXPECT_THAT(document.floats(2, 1), ElementsAre(-32768, 32767));
  EXPECT_THAT(document.integers(3, 1), ElementsAre(0, 65535));
  EXPECT_THAT(document.integers(4, 1), ElementsAre(0, 4000000000u));
  EXPECT_THAT(document.floats(5, 1), ElementsAre(-1.5f, 1e30f));
}

TEST(GltfAccessors, NormaliseIntegersAsTheSpecificationSays) {
  TinyGltf file;
  file.add<std::int8_t>({-128, -127, 127}, 1, "SCALAR", R"(,"normalized":true)");
  file.add<std::uint16_t>({0, 65535, 13107}, 1, "SCALAR", R"(,"normalized":true)");
  const GltfDocument document = parsed(file);
  EXPECT_THAT(document.floats(0, 1), ElementsAre(-1, -1, 1));
  EXPECT_THAT(document.floats(1, 1), ElementsAre(0, 1, 0.2f));
}

TEST(GltfAccessors, StepOverInterleavedData) {
  TinyGltf file;
  const std::vector<float> data = {1, 2, 3, 10, 20, 4, 5, 6, 30, 40};
  file.addView(data.data(), 40, R"(,"byteStride":20)");
  file.addAccessor(R"("bufferView":0,"componentType":5126,"count":2,"type":"VEC3")");
  file.addAccessor(
      R"("bufferView":0,"byteOffset":12,"componentType":5126,"count":2,"type":"VEC2")");
  const GltfDocument document = parsed(file);
  EXPECT_THAT(document.floats(0, 3), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(document.floats(1, 2), ElementsAre(10, 20, 30, 40));
}

TEST(GltfAccessors, BeginColumnsOfSmallMatricesAtMultiplesOfFour) {
  TinyGltf file;
  const std::vector<std::uint8_t> data = {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0};
  file.addView(data.data(), data.size());
  file.addAccessor(R"("bufferView":0,"componentType":5121,"count":1,"type":"MAT3")");
  EXPECT_THAT(parsed(file).integers(0, 9), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST(GltfAccessors, ReplaceSparseElements) {
  TinyGltf file;
  file.add<float>({1, 2, 3, 4, 5, 6}, 2, "VEC2");
  const std::vector<std::uint16_t> where = {1};
  const std::vector<float> what = {-3, -4};
  file.addView(where.data(), 2);
  file.addView(what.data(), 8);
  const std::string sparse =
      R"("sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":2}})";
  file.addAccessor(R"("bufferView":0,"componentType":5126,"count":3,"type":"VEC2",)" + sparse);
  file.addAccessor(R"("componentType":5126,"count":2,"type":"VEC2",)" + sparse);
  const GltfDocument document = parsed(file);
  EXPECT_THAT(document.floats(1, 2), ElementsAre(1, 2, -3, -4, 5, 6));
  EXPECT_THAT(document.floats(2, 2), ElementsAre(0, 0, -3, -4));
}

TEST(GltfAccessors, SayWhereTheyReachTooFar) {
  TinyGltf file;
  file.add<float>({1, 2, 3}, 3, "VEC3");
  file.addAccessor(R"("bufferView":0,"componentType":5126,"count":2,"type":"VEC3")");
  file.addAccessor(R"("bufferView":0,"byteOffset":4,"componentType":5126,"count":1,"type":"VEC3")");
  file.addAccessor(
      R"("bufferView":0,"componentType":5126,"count":4611686018427387904,"type":"VEC3")");
  file.addAccessor(R"("bufferView":7,"componentType":5126,"count":1,"type":"VEC3")");
  file.addAccessor(R"("componentType":5126,"count":4000000000,"type":"MAT4")");
  file.addAccessor(R"("bufferView":0,"componentType":5124,"count":1,"type":"VEC3")");
  const GltfDocument document = parsed(file);
  EXPECT_EQ(document.floats(0, 3).size(), 3u);
  EXPECT_THROW(document.floats(0, 2), Error);
  for (int accessor = 1; accessor <= 6; ++accessor) {
    const std::string text =
        complaintOf([&] { document.floats(accessor, accessor == 5 ? 16 : 3); });
    EXPECT_THAT(text, HasSubstr("sample.glb:1: /accessors/" + std::to_string(accessor)));
  }
  EXPECT_THROW(document.floats(7, 3), Error);
  EXPECT_THROW(document.floats(-1, 3), Error);
}

TEST(GltfDocument, ReadsDataUrisAndFilesBesideIt) {
  const sample::Folder folder;
  TinyGltf file;
  file.add<std::uint8_t>({77, 97, 110, 33}, 1, "SCALAR");
  save(folder / "a.gltf", file.json(R"(,"uri":"data:application/octet-stream;base64,TWFuIQ==")"));
  save(folder / "b.gltf", file.json(R"(,"uri":"my%20data.bin")"));
  save(folder / "my data.bin", "Man!");
  for (const char* name : {"a.gltf", "b.gltf"}) {
    EXPECT_THAT(GltfDocument::read(folder / name).integers(0, 1), ElementsAre(77, 97, 110, 33));
  }
}

TEST(GltfDocument, NeverReadsOutsideOfItsFolder) {
  const sample::Folder folder;
  save(folder / "secret.bin", "Man!");
  TinyGltf file;
  file.add<std::uint8_t>({1, 2, 3, 4}, 1, "SCALAR");
  for (const std::string uri :
       {"../secret.bin", "/etc/passwd", "file:///etc/passwd", "https://example.org/a.bin",
        "..%2fsecret.bin", "%2fetc%2fpasswd", "a/../../secret.bin", "missing.bin", "",
        "data:application/octet-stream,Man!", "data:;base64,????"}) {
    save(folder / "a.gltf", file.json(R"(,"uri":")" + uri + "\""));
    EXPECT_THAT(complaintOf([&] { GltfDocument::read(folder / "a.gltf"); }),
                HasSubstr("/buffers/0"))
        << uri;
  }
}

TEST(GltfDocument, RefusesRequiredExtensionsItDoesNotKnow) {
  TinyGltf file;
  file.more = R"(,"extensionsUsed":["ACME_fur"],"extensionsRequired":["ACME_fur"])";
  EXPECT_THAT(complaint(file.glb()), HasSubstr("requires the extension \"ACME_fur\""));
  file.more = R"(,"extensionsUsed":["ACME_fur"])";
  EXPECT_EQ(complaint(file.glb()), "");
  file.more = R"(,"extensionsRequired":["KHR_materials_unlit","KHR_texture_basisu"])";
  EXPECT_EQ(complaint(file.glb()), "");
}

TEST(GltfDocument, SaysWhatIsNoGltf) {
  EXPECT_THAT(complaint(""), HasSubstr("sample.glb"));
  EXPECT_THAT(complaint("{}"), HasSubstr("no glTF 2.0"));
  EXPECT_THAT(complaint(R"({"asset":{"version":"1.0"}})"), HasSubstr("found 1.0"));
  EXPECT_THAT(complaint("[]"), HasSubstr("expected an object"));
  EXPECT_THAT(complaint(R"({"asset":)"), HasSubstr("parse error"));
}

TEST(GltfDocument, CutShortAnywhereIsAnError) {
  const std::string glb = TubeRig().file.glb();
  for (std::size_t n = 0; n < glb.size(); ++n) {
    EXPECT_NE(complaint(glb.substr(0, n)), "") << n;
  }
  EXPECT_EQ(complaint(glb), "");
}

TEST(GltfDocument, KeepsWhatItDoesNotUnderstand) {
  const sample::Folder folder;
  TubeRig rig;
  rig.file.materials =
      R"([{"name":"fur","extensions":{"KHR_materials_sheen":{"sheenColorFactor":[0.1,0.20,1e-3]}},"extras":{"a":[1,null,"é"]}}])";
  rig.file.more = R"(,"extensionsUsed":["KHR_materials_sheen"],"extras":{"studio":{"x":true}})";
  parsed(rig.file).writeGlb(folder / "a.glb");
  const GltfDocument before = parsed(rig.file), after = GltfDocument::read(folder / "a.glb");
  for (const char* part : {"asset", "materials", "extras", "extensionsUsed", "nodes", "skins",
                           "meshes", "scenes", "accessors"}) {
    EXPECT_EQ(printJson(*before.json().find(part)), printJson(*after.json().find(part))) << part;
  }
  EXPECT_EQ(before.floats(rig.positions, 3), after.floats(rig.positions, 3));
  EXPECT_EQ(before.integers(rig.indices, 1), after.integers(rig.indices, 1));
}

TEST(GltfDocument, DropsDataThatNothingUses) {
  const sample::Folder folder;
  TubeRig rig;
  rig.file.add(std::vector<float>(10000, 1.f), 1, "SCALAR");
  const int late = rig.file.add(TubeRig::ringPositions(), 3, "VEC3");
  rig.positions = late;
  rig.file.meshes = "[" + TubeRig::meshOf(rig.primitive()) + "]";
  const GltfDocument document = parsed(rig.file);
  document.writeGlb(folder / "a.glb");
  const GltfDocument after = GltfDocument::read(folder / "a.glb");
  EXPECT_EQ(after.root()["accessors"].size(), 5u);
  EXPECT_LT(readFile(folder / "a.glb", 1 << 24).size(), 3000u);
  const GltfPlace attributes = after.root()["meshes"].at(0)["primitives"].at(0)["attributes"];
  EXPECT_EQ(after.floats(attributes["POSITION"].index(5), 3), TubeRig::ringPositions());
  // An extension that may point at any accessor forbids renumbering.
  rig.file.more = R"(,"extensionsUsed":["ACME_fur"])";
  parsed(rig.file).writeGlb(folder / "b.glb");
  EXPECT_EQ(GltfDocument::read(folder / "b.glb").root()["accessors"].size(), 7u);
}

TEST(GltfDocument, PacksPicturesIntoTheFile) {
  const sample::Folder folder;
  const std::string png = "\x89PNG\r\n\x1a\n not really";
  save(folder / "skin.png", png);
  TinyGltf file;
  file.images =
      R"([{"uri":"skin.png"},{"uri":"data:image/png;base64,iVBORw0KGgo="},{"uri":"no.png"}])";
  save(folder / "a.gltf", file.json());
  GltfDocument::read(folder / "a.gltf").writeGlb(folder / "b.glb");
  std::remove((folder / "skin.png").c_str());
  const GltfDocument after = GltfDocument::read(folder / "b.glb");
  const std::vector<std::uint8_t> picture = after.image(0);
  EXPECT_EQ(std::string(picture.begin(), picture.end()), png);
  EXPECT_EQ(after.image(1).size(), 8u);
  EXPECT_TRUE(after.image(2).empty());
  EXPECT_EQ(after.root()["images"].at(0)["mimeType"].text(), "image/png");
}

TEST(GltfDocument, UnpacksMeshoptViews) {
  TubeRig plain, packed;
  const auto addPacked = [&](const void* data, std::size_t bytes, std::size_t count,
                             std::size_t stride, const char* mode) {
    const int view = packed.file.addView(data, bytes);
    packed.file.views.back() =
        R"({"buffer":1,"byteLength":)" + std::to_string(count * stride) +
        R"(,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteOffset":)" +
        std::to_string(packed.file.binary.size() - bytes) + R"(,"byteLength":)" +
        std::to_string(bytes) + R"(,"byteStride":)" + std::to_string(stride) + R"(,"count":)" +
        std::to_string(count) + R"(,"mode":")" + mode + R"("}}})";
    return view;
  };
  const std::vector<float> positions = TubeRig::ringPositions();
  std::vector<std::uint8_t> bytes(meshopt_encodeVertexBufferBound(12, 12));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), positions.data(), 12, 12));
  addPacked(bytes.data(), bytes.size(), 12, 12, "ATTRIBUTES");
  const std::vector<std::uint16_t> ring = TubeRig::ringIndices();
  const std::vector<std::uint32_t> indices(ring.begin(), ring.end());
  std::vector<std::uint8_t> order(meshopt_encodeIndexBufferBound(indices.size(), 12));
  order.resize(
      meshopt_encodeIndexBuffer(order.data(), order.size(), indices.data(), indices.size()));
  addPacked(order.data(), order.size(), indices.size(), 2, "TRIANGLES");
  std::vector<std::string>& accessors = packed.file.accessors;
  accessors[0] = R"({"bufferView":5,"componentType":5126,"count":12,"type":"VEC3"})";
  accessors[3] = R"({"bufferView":6,"componentType":5123,"count":48,"type":"SCALAR"})";
  packed.file.more =
      R"(,"extensionsUsed":["EXT_meshopt_compression"],"extensionsRequired":["EXT_meshopt_compression"])";
  std::string text = packed.file.json();
  const std::string one = "}]";  // the second buffer only stands in for the unpacked data
  const std::size_t at = text.find(one, text.find("\"buffers\""));
  text.replace(at, one.size(), R"(},{"byteLength":240}])");

  const GltfDocument document = [&] {
    TinyGltf shell = packed.file;
    return GltfDocument::parse(sample::glbOf(text, shell.binary), "packed.glb");
  }();
  EXPECT_EQ(document.floats(0, 3), positions);
  const RiggedModel a = rigFromGltf(parsed(plain.file)), b = rigFromGltf(document);
  EXPECT_EQ(a.points_m, b.points_m);
  EXPECT_EQ(a.triangles.size(), b.triangles.size());
  EXPECT_EQ(document.json().find("extensionsRequired"), nullptr);
  const sample::Folder folder;
  document.writeGlb(folder / "a.glb");
  EXPECT_EQ(GltfDocument::read(folder / "a.glb").floats(0, 3), positions);
}

// The tube's positions, joints and weights in one Draco buffer.
std::vector<char> dracoTube() {
  const std::vector<float> positions = TubeRig::ringPositions(), weights = TubeRig::ringWeights();
  const std::vector<std::uint8_t> joints = TubeRig::ringJoints();
  const std::vector<std::uint16_t> indices = TubeRig::ringIndices();
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(indices.size() / 3));
  const int p = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int j = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT8);
  const int w = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_FLOAT32);
  for (std::size_t f = 0; f < indices.size() / 3; ++f) {
    const draco::FaceIndex face(static_cast<std::uint32_t>(f));
    const std::size_t a = indices[3 * f], b = indices[3 * f + 1], c = indices[3 * f + 2];
    builder.SetAttributeValuesForFace(p, face, &positions[3 * a], &positions[3 * b],
                                      &positions[3 * c]);
    builder.SetAttributeValuesForFace(j, face, &joints[4 * a], &joints[4 * b], &joints[4 * c]);
    builder.SetAttributeValuesForFace(w, face, &weights[4 * a], &weights[4 * b], &weights[4 * c]);
  }
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

TubeRig dracoRig(const std::vector<char>& data) {
  TubeRig rig;
  const int view = rig.file.addView(data.data(), data.size());
  rig.file.accessors[0] = R"({"componentType":5126,"count":12,"type":"VEC3"})";
  rig.file.accessors[1] = R"({"componentType":5121,"count":12,"type":"VEC4"})";
  rig.file.accessors[2] = R"({"componentType":5126,"count":12,"type":"VEC4"})";
  rig.file.accessors[3] = R"({"componentType":5123,"count":48,"type":"SCALAR"})";
  rig.file.meshes =
      "[" +
      TubeRig::meshOf(rig.primitive(
          R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":)" + std::to_string(view) +
          R"(,"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}})")) +
      "]";
  rig.file.more =
      R"(,"extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"])";
  return rig;
}

TEST(GltfDocument, UnpacksDracoMeshes) {
  const GltfDocument document = parsed(dracoRig(dracoTube()).file);
  const RiggedModel model = rigFromGltf(document), plain = rigFromGltf(parsed(TubeRig().file));
  ASSERT_EQ(model.points_m.size(), plain.points_m.size());
  EXPECT_EQ(model.triangles.size(), plain.triangles.size());
  for (std::size_t i = 0; i < model.points_m.size(); ++i) {  // Draco orders points its own way
    std::size_t same = 0;
    for (std::size_t k = 0; k < plain.points_m.size(); ++k) {
      if (model.points_m[i] != plain.points_m[k]) continue;
      ++same;
      EXPECT_EQ(model.weights[i].weight, plain.weights[k].weight);
      EXPECT_EQ(model.weights[i].joint, plain.weights[k].joint);
    }
    EXPECT_EQ(same, 1u);
  }
  const sample::Folder folder;
  document.writeGlb(folder / "a.glb");
  EXPECT_EQ(rigFromGltf(GltfDocument::read(folder / "a.glb")).points_m, model.points_m);
}

TEST(GltfDocument, DamagedDracoDataAreAnError) {
  const std::vector<char> good = dracoTube();
  std::mt19937 random(3);
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    std::vector<char> bad = good;
    for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = static_cast<char>(random());
    if (i % 4 == 0) bad.resize(random() % bad.size());
    refused += complaint(dracoRig(bad).file.glb()).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 300);
}

TEST(GltfDocument, SurvivesFlippedBytes) {
  TubeRig rig;
  rig.file.animations =
      "[" + rig.animation("bend", 2, "rotation", {0, 1}, {0, 0, 0, 1, 1, 0, 0, 0}) + "]";
  const std::string good = rig.file.glb();
  std::mt19937 random(7);
  const sample::Folder folder;
  int read = 0, rigged = 0;
  for (int i = 0; i < 6000; ++i) {
    std::string bad = good;
    for (auto n = 1 + random() % 3; n > 0; --n) {
      const std::size_t at = random() % bad.size();
      bad[at] = random() % 2 == 0 ? static_cast<char>(random())
                                  : static_cast<char>(bad[at] ^ (1 << random() % 8));
    }
    try {
      const GltfDocument document = GltfDocument::parse(bad, "bad.glb");
      ++read;
      if (i % 20 == 0) document.writeGlb(folder / "bad.glb");
      rigFromGltf(document);
      ++rigged;
    } catch (const Error& error) {
      EXPECT_FALSE(error.issues().empty());
    }
  }
  EXPECT_GT(rigged, 500);
  EXPECT_LT(rigged, 5500);
  EXPECT_GT(read, rigged);
}

TEST(GltfDocument, RealCharactersComeBackWhole) {
  const auto file = assetFile("mesh2motion-cc0/fox-animations.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  const sample::Folder folder;
  const GltfDocument before = GltfDocument::read(file->string());
  before.writeGlb(folder / "fox.glb");
  const GltfDocument after = GltfDocument::read(folder / "fox.glb");
  EXPECT_EQ(printJson(*before.json().find("materials")),
            printJson(*after.json().find("materials")));
  EXPECT_EQ(before.image(0), after.image(0));
  const RiggedModel a = rigFromGltf(before), b = rigFromGltf(after);
  EXPECT_EQ(a.points_m, b.points_m);
  ASSERT_EQ(a.motions.size(), b.motions.size());
  for (std::size_t m = 0; m < a.motions.size(); ++m) {
    EXPECT_EQ(a.motions[m].translation_m, b.motions[m].translation_m);
  }
}

TEST(GltfFiles, BuffersOfOneFileAreReadOnceAndWrittenOnce) {
  const sample::Folder folder;
  writeFileWhole(folder / "data.bin", std::string(1 << 20, 'x'));
  std::filesystem::create_symlink("data.bin", folder / "same.bin");
  std::string buffers, views;
  for (int i = 0; i < 4000; ++i) {
    const std::string end = i == 0 ? "" : ",";
    const std::string name = i % 2 == 0 ? "data.bin" : "same.bin";
    buffers.append(end).append(R"({"byteLength": 1048576, "uri": ")" + name + "\"}");
    views.append(end).append(R"({"byteLength": 1048576, "buffer": )" + std::to_string(i) + "}");
  }
  writeFileWhole(folder / "a.gltf", R"({"asset": {"version": "2.0"}, "buffers": [)" + buffers +
                                        R"(], "bufferViews": [)" + views + "]}");
  const GltfDocument document = GltfDocument::read(folder / "a.gltf");
  EXPECT_EQ(document.viewBytes(0).data(), document.viewBytes(3999).data());
  EXPECT_LT(document.glb().size(), std::size_t{3} << 20);
}

TEST(GltfFiles, WhatIsAddedToACopyIsNotInTheOriginal) {
  GltfDocument document;
  const std::vector<float> numbers{1, 2, 3};
  document.addFloats(numbers, "SCALAR");
  const std::string before = document.glb();
  GltfDocument copy = document;
  copy.addFloats(numbers, "SCALAR");
  EXPECT_EQ(document.viewBytes(0).size(), 12u);
  EXPECT_EQ(document.glb(), before);
}

}  // namespace
}  // namespace fascia
