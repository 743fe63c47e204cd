#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/pc2.h>
#include <fascia/io/file/file.h>
#include <fascia/world/performance.h>

#include "sample.h"
#include "scene_sample.h"

namespace fascia {
namespace {

// Flips, cuts, repeats and swaps bytes; the same for the same seed.
std::string mutated(std::string bytes, std::mt19937& random) {
  const auto at = [&] { return random() % (bytes.size() + 1); };
  static const std::string kWords[] = {"{", "[",     "]",  "\"",   ":",
                                       ",", "1e308", "-1", "null", "\xff"};
  for (unsigned n = 1 + random() % 4; n > 0 && !bytes.empty(); --n) {
    switch (random() % 5) {
      case 0:
        bytes[at() % bytes.size()] = static_cast<char>(random());
        break;
      case 1:
        bytes.erase(at(), random() % 9);
        break;
      case 2:
        bytes.insert(at(), kWords[random() % std::size(kWords)]);
        break;
      case 3:
        bytes.insert(at(), bytes.substr(at(), random() % 60));
        break;
      case 4:
        bytes.resize(random() % 20 == 0 ? at() : bytes.size());
        break;
    }
  }
  return bytes;
}

// Either it reads, or it throws Error; anything else fails the test. Returns how many read.
template <class Read>
int readMutations(const std::string& good, int count, const Read& read) {
  std::mt19937 random(1);
  int accepted = 0;
  for (int i = 0; i < count; ++i) {
    try {
      read(mutated(good, random));
      ++accepted;
    } catch (const Error& error) {
      EXPECT_FALSE(error.issues().empty());
    }
  }
  return accepted;
}

TEST(Mutations, CharacterFileReadsOrSaysWhyNot) {
  const int accepted = readMutations(sample::kFull, 4000, [](const std::string& text) {
    characterText(readCharacterText(text).def);  // what reads can be written
  });
  EXPECT_GT(accepted, 10);
  EXPECT_LT(accepted, 3000);
}

TEST(Mutations, ScenesOfTheExamplesReadOrSayWhyNot) {
  int scenes = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(FASCIA_SOURCE_DIR) / "examples")) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".fascia.json") || !isSceneFile(path)) continue;
    const int accepted = readMutations(readFile(path, 1 << 20), 400, [](const std::string& text) {
      sceneText(readSceneText(text).def);
    });
    EXPECT_GT(accepted, 10) << path;
    EXPECT_LT(accepted, 350) << path;
    ++scenes;
  }
  EXPECT_GT(scenes, 2);
}

TEST(Mutations, ScenesThatReadArePerformedOrSayWhyNot) {
  int accepted = 0;
  for (const char* text : {sample::kSmallScene, sample::kFlatScene})
    accepted += readMutations(text, 150, [](const std::string& mutant) {
      const Stage stage(readSceneText(mutant).def);
      Performance(stage, 1).advance(1.0 / 60);
    });
  EXPECT_GT(accepted, 10);
  EXPECT_LT(accepted, 200);
}

TEST(Mutations, CacheReadsOrSaysWhyNot) {
  const sample::Folder folder;
  const CharacterDef def = readCharacterText(sample::kFull).def;
  writeCache(def, sample::tube(3, 3), folder / "a.fcache");
  const std::string good = readFile(folder / "a.fcache", 1 << 24);
  const int accepted =
      readMutations(good, 3000, [](const std::string& bytes) { parseCache(bytes); });
  EXPECT_GT(accepted, 10);
  EXPECT_LT(accepted, 2500);
}

TEST(Mutations, PointCacheReadsOrSaysWhyNot) {
  const sample::Folder folder;
  writePc2(sample::tube(3, 3), folder / "a.pc2");
  const std::string good = readFile(folder / "a.pc2", 1 << 24);
  const int accepted = readMutations(good, 3000, [](const std::string& bytes) { parsePc2(bytes); });
  EXPECT_GT(accepted, 10);
}

}  // namespace
}  // namespace fascia
