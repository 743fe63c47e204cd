#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include <fascia/io/documents/scene_file.h>
#include <fascia/io/file/file.h>

#include "sample.h"

namespace fascia {
namespace {

namespace fs = std::filesystem;

const std::string kRoot = FASCIA_SOURCE_DIR;

const valijson::Schema* parsed(const std::string& text) {
  const nlohmann::json document = nlohmann::json::parse(text);
  auto* schema = new valijson::Schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(document),
                                          *schema);
  return schema;
}

bool accepts(const valijson::Schema& schema, const std::string& text) {
  const nlohmann::json document = nlohmann::json::parse(text);
  valijson::Validator validator;
  return validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(document), nullptr);
}

bool schemaAccepts(const std::string& text) {
  static const valijson::Schema* const kSchema = parsed(characterSchema());
  return accepts(*kSchema, text);
}

bool sceneSchemaAccepts(const std::string& text) {
  static const valijson::Schema* const kSchema = parsed(sceneSchema());
  return accepts(*kSchema, text);
}

void expectPublished(const std::string& name, const std::string& schema) {
  const std::string path = kRoot + "/schema/" + name;
  if (std::getenv("FASCIA_UPDATE_SCHEMA")) writeFileWhole(path, schema);
  EXPECT_EQ(readFile(path, 1 << 20), schema)
      << "run this test once with FASCIA_UPDATE_SCHEMA=1 to write it anew";
}

TEST(Schema, PublishedFilesAreThoseThatTheReadersMake) {
  expectPublished("fascia-1.schema.json", characterSchema());
  expectPublished("fascia-scene-1.schema.json", sceneSchema());
}

TEST(Schema, AcceptsTheSamples) {
  EXPECT_TRUE(schemaAccepts(sample::kMinimal));
  EXPECT_TRUE(schemaAccepts(sample::kFull));
  EXPECT_TRUE(schemaAccepts(sample::kRigged));
}

TEST(Schema, AcceptsEveryExampleThatTheReaderAccepts) {
  if (!fs::exists(kRoot + "/examples")) GTEST_SKIP() << "no examples";
  for (const auto& entry : fs::recursive_directory_iterator(kRoot + "/examples")) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".fascia.json")) continue;
    if (isSceneFile(path)) {
      EXPECT_NO_THROW(loadStage(path)) << path;
      EXPECT_TRUE(sceneSchemaAccepts(readFile(path, 1 << 26))) << path;
      continue;
    }
    EXPECT_NO_THROW(readCharacterFile(path)) << path;
    EXPECT_TRUE(schemaAccepts(readFile(path, 1 << 26))) << path;
  }
}

// A skin has ends where it is a grid, and none where it is a rig's mesh.
TEST(Schema, RefusesSkinsWithoutSurfaceOrWithTwo) {
  const nlohmann::json grid = nlohmann::json::parse(sample::kMinimal);
  const nlohmann::json rigged = nlohmann::json::parse(sample::kRigged);
  std::vector<nlohmann::json> wrong;
  for (const char* end : {"bottom", "top"}) {
    wrong.push_back(grid);
    wrong.back()["skin"].erase(end);
    wrong.push_back(rigged);
    wrong.back()["skin"][end] = {{"joint", "root"}};
  }
  wrong.push_back(rigged);
  wrong.back()["skin"]["grid"] = {16, 16};
  wrong.push_back(grid);
  wrong.back()["skin"]["parts"] = nlohmann::json::array();
  wrong.push_back(rigged);
  wrong.back().erase("rig");
  wrong.push_back(rigged);
  wrong.back()["rig"].erase("file");
  wrong.push_back(rigged);
  wrong.back()["rig"]["scale"] = 0;
  for (const nlohmann::json& document : wrong) {
    EXPECT_FALSE(sample::faults(document.dump()).empty()) << document;
    EXPECT_FALSE(schemaAccepts(document.dump())) << document;
  }
}

// Replaces one member or entry at a time of the sample with something impossible.
TEST(Schema, RefusesWhatTheReaderRefuses) {
  const nlohmann::json sample = nlohmann::json::parse(sample::kFull);
  const nlohmann::json flat = sample.flatten();
  int refused = 0;
  for (const auto& [pointer, value] : flat.items()) {
    nlohmann::json broken = sample;
    broken[nlohmann::json::json_pointer(pointer)] = nlohmann::json{{"impossible", true}};
    EXPECT_FALSE(sample::faults(broken.dump()).empty()) << pointer;
    EXPECT_FALSE(schemaAccepts(broken.dump())) << pointer;
    ++refused;
  }
  EXPECT_GT(refused, 100);
}

TEST(Schema, RefusesUnknownKeysWhereverTheReaderDoes) {
  const nlohmann::json sample = nlohmann::json::parse(sample::kFull);
  std::vector<std::string> objects;
  const std::function<void(const nlohmann::json&, const std::string&)> visit =
      [&](const nlohmann::json& value, const std::string& pointer) {
        if (value.is_object()) objects.push_back(pointer);
        if (!value.is_structured()) return;
        for (const auto& [key, child] : value.items()) visit(child, pointer + '/' + key);
      };
  visit(sample, "");
  ASSERT_GT(objects.size(), 20u);
  for (const std::string& pointer : objects) {
    nlohmann::json broken = sample;
    broken[nlohmann::json::json_pointer(pointer)]["surplus"] = 1;
    EXPECT_FALSE(sample::faults(broken.dump()).empty()) << pointer;
    EXPECT_FALSE(schemaAccepts(broken.dump())) << pointer;
  }
}

}  // namespace
}  // namespace fascia
