#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include <unistd.h>

#include <fascia/base/random.h>
#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/pc2.h>
#include <fascia/io/documents/stats_writer.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/file/file.h>
#include <fascia/io/picture/texture.h>
#include <fascia/io/picture/video_writer.h>

#include "sample.h"

namespace fascia {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

Image gradient(int width, int height, int shift = 0) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    for (const int c : {i + shift, i / width, 255 - i % 256, 255}) {
      image.rgba.push_back(static_cast<std::uint8_t>(c));
    }
  }
  return image;
}

TEST(WholeFile, LeavesTheOldFileUntilCommit) {
  const sample::Folder folder;
  const std::string path = folder / "a";
  writeFileWhole(path, "old");
  {
    WholeFile file(path);
    file.write("new");
  }
  EXPECT_EQ(readFile(path, 100), "old");
  EXPECT_EQ(folder.entryCount(), 1u);
  writeFileWhole(path, "new");
  EXPECT_EQ(readFile(path, 100), "new");
}

TEST(WholeFile, RefusesMissingFoldersAndFolders) {
  const sample::Folder folder;
  EXPECT_THROW(writeFileWhole(folder / "no/a", "x"), Error);
  EXPECT_THROW(writeFileWhole(folder.path(), "x"), Error);
}

TEST(ReadFile, RefusesTooLargeFilesAndPipes) {
  const sample::Folder folder;
  writeFileWhole(folder / "a", "12345");
  EXPECT_THROW(readFile(folder / "a", 4), Error);
  EXPECT_EQ(readFile(folder / "a", 5), "12345");
  EXPECT_THROW(readFile("/dev/zero", 100), Error);
}

TEST(PointCache, ComesBackExactly) {
  const sample::Folder folder;
  const Recording recording = sample::tube(0, 5);
  writePc2(recording, folder / "a.pc2");
  const PointCache cache = readPc2(folder / "a.pc2");
  ASSERT_EQ(cache.pointCount, recording.skin.positions.size());
  ASSERT_EQ(cache.sampleCount(), 5u);
  for (std::size_t f = 0; f < 5; ++f) {
    for (std::size_t v = 0; v < cache.pointCount; ++v) {
      ASSERT_EQ(cache.positions_m[f * cache.pointCount + v], recording.frames[f].skin_m[v]);
    }
  }
}

TEST(Cache, ComesBackExactly) {
  const sample::Folder folder;
  const CharacterDef def = readCharacterText(sample::kFull).def;
  const Recording in = sample::tube(3, 6);
  const Texture texture{encodePng(gradient(4, 4)), {}};
  writeCache(def, in, folder / "a.fcache", &texture);
  const Cache cache = readCache(folder / "a.fcache");
  EXPECT_EQ(characterText(cache.def), characterText(def));
  EXPECT_EQ(cache.texture.bytes, texture.bytes);
  const Recording& out = cache.recording;
  EXPECT_EQ(out.motion, in.motion);
  EXPECT_EQ(out.loop, in.loop);
  EXPECT_EQ(out.frame_rate_hz, in.frame_rate_hz);
  EXPECT_EQ(out.skin.triangles, in.skin.triangles);
  EXPECT_EQ(out.skin.uvs, in.skin.uvs);
  ASSERT_EQ(out.frames.size(), in.frames.size());
  for (std::size_t f = 0; f < in.frames.size(); ++f) {
    EXPECT_EQ(out.frames[f].time_s, in.frames[f].time_s);
    EXPECT_EQ(out.frames[f].posture, in.frames[f].posture);
    EXPECT_EQ(out.frames[f].skin_m, in.frames[f].skin_m);
  }
  EXPECT_EQ(out.stats.rejected_steps, 3u);
  EXPECT_EQ(out.state_hash, in.state_hash);
}

TEST(Cache, HoldsNoTimesThatWereMeasured) {
  const CharacterDef def = readCharacterText(sample::kFull).def;
  Recording slow = sample::tube(3, 6);
  const std::string bytes = cacheBytes(def, slow);
  slow.wall_s = 9;
  slow.stats.forces_s = slow.stats.constraints_s = slow.stats.other_s = 5;
  EXPECT_TRUE(cacheBytes(def, slow) == bytes);
  slow.stats.steps += 1;
  EXPECT_FALSE(cacheBytes(def, slow) == bytes);
}

TEST(Cache, KeepsTheShapesOfSoftSolids) {
  const sample::Folder folder;
  const CharacterDef def = readCharacterText(sample::kFull).def;
  Recording in = sample::tube(3, 4);
  for (std::size_t f = 0; f < in.frames.size(); ++f)
    in.frames[f].soft_shapes = {0.1, 0.2 * static_cast<double>(f), -3};
  writeCache(def, in, folder / "a.fcache");
  const Recording out = readCache(folder / "a.fcache").recording;
  for (std::size_t f = 0; f < in.frames.size(); ++f) {
    EXPECT_EQ(out.frames[f].soft_shapes, in.frames[f].soft_shapes);
    EXPECT_EQ(out.frames[f].skin_m, in.frames[f].skin_m);
  }
  in.frames[2].soft_shapes.pop_back();
  EXPECT_THROW(writeCache(def, in, folder / "b.fcache"), Error);
}

TEST(Cache, RefusesEveryTruncation) {
  const sample::Folder folder;
  writeCache(readCharacterText(sample::kMinimal).def, sample::tube(0, 2), folder / "a");
  const std::string bytes = readFile(folder / "a", 1 << 24);
  for (std::size_t size = 0; size < bytes.size(); size += 37) {
    EXPECT_THROW(parseCache(bytes.substr(0, size)), Error) << size;
  }
}

TEST(Cache, RefusesARecordingOfAnotherCharacter) {
  const sample::Folder folder;
  const CharacterDef def = readCharacterText(sample::kFull).def;
  EXPECT_THROW(writeCache(def, sample::tube(1, 2), folder / "a"), Error);
  EXPECT_EQ(folder.entryCount(), 0u);
}

TEST(Image, PngComesBackExactly) {
  const Image image = gradient(33, 7);
  const Image back = decodeImage(encodePng(image));
  EXPECT_EQ(back.width, 33);
  EXPECT_EQ(back.height, 7);
  EXPECT_EQ(back.rgba, image.rgba);
}

TEST(Image, OpaquePicturesComeBackExactlyAndTakeLess) {
  Image image = gradient(64, 48);
  Random random(3);
  for (std::uint8_t& byte : image.rgba) byte = static_cast<std::uint8_t>(random.next());
  const std::size_t withAlpha = encodePng(image).size();
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  const std::string bytes = encodePng(image);
  EXPECT_EQ(decodeImage(bytes).rgba, image.rgba);
  EXPECT_LT(bytes.size(), withAlpha);
}

TEST(Image, DamagedPicturesAreErrors) {
  const std::string png = encodePng(gradient(33, 7));
  EXPECT_THROW(decodeImage(png.substr(0, png.size() / 2)), Error);
  EXPECT_THROW(decodeImage("hello"), Error);
  EXPECT_THROW(decodeImage("\xff\xd8\xff\xe0 no jpeg"), Error);
}

TEST(Texture, StaysInsideTheFolder) {
  const sample::Folder outside, folder;
  writePng(gradient(4, 4), outside / "secret.png");
  writePng(gradient(4, 4), folder / "skin.png");
  fs::create_symlink(outside / "secret.png", folder / "link.png");
  writeFileWhole(folder / "text.png", "no picture");
  CharacterDef def = readCharacterText(sample::kMinimal).def;
  def.folder = folder.path();
  def.skin->texture = "skin.png";
  EXPECT_FALSE(loadTexture(def).empty());
  const std::string climbing = "../" + fs::path(outside.path()).filename().string() + "/secret.png";
  for (const std::string& name :
       {outside / "secret.png", climbing, std::string("link.png"), std::string("text.png"),
        std::string("."), std::string("none.png"), std::string("a\0b", 3)}) {
    def.skin->texture = name;
    EXPECT_THROW(loadTexture(def), Error) << name;
  }
}

TEST(Stats, HoldsEveryKey) {
  const std::string text = statsJson(sample::tube(0, 2));
  for (const char* key :
       {"vertices", "simulated_s", "wall_s", "realtime_ratio", "steps", "rejected_steps",
        "step_min_s", "step_max_s", "share_forces", "share_constraints", "share_other",
        "max_penetration_m", "max_edge_stretch", "peak_memory_bytes", "state_hash"}) {
    EXPECT_THAT(text, HasSubstr(std::string("\"") + key + "\": "));
  }
  EXPECT_THAT(text, HasSubstr("\"share_forces\": 0.75"));
  EXPECT_THAT(text, HasSubstr("\"realtime_ratio\": 2"));
  EXPECT_THAT(text, HasSubstr("\"state_hash\": \"0123456789abcdef\""));
}

TEST(Video, WithoutTheProgramBecomesPictures) {
  const sample::Folder folder;
  VideoOptions options;
  options.encoder = "no-such-encoder";
  VideoWriter video(folder / "clip.mp4", 8, 6, options);
  EXPECT_FALSE(video.encodes());
  EXPECT_THAT(video.hint(), HasSubstr("no-such-encoder"));
  video.add(gradient(8, 6));
  video.add(gradient(8, 6, 9));
  video.finish();
  EXPECT_EQ(readImage(folder / "clip/00001.png").rgba, gradient(8, 6, 9).rgba);
  EXPECT_EQ(folder.entryCount(), 1u);
}

TEST(Video, EncodesOddSizes) {
  if (findProgram("ffmpeg").empty()) GTEST_SKIP() << "ffmpeg is not installed";
  const sample::Folder folder;
  VideoWriter video(folder / "clip.mp4", 33, 17);
  for (int f = 0; f < 5; ++f) video.add(gradient(33, 17, 10 * f));
  video.finish();
  EXPECT_EQ(folder.entryCount(), 1u);
  EXPECT_THAT(readFile(folder / "clip.mp4", 1 << 24).substr(0, 12), HasSubstr("ftyp"));
}

TEST(Video, StoppedHalfWayLeavesNothing) {
  const sample::Folder folder;
  for (const char* encoder : {"ffmpeg", "no-such-encoder"}) {
    VideoOptions options;
    options.encoder = encoder;
    VideoWriter video(folder / "clip.mp4", 16, 16, options);
    video.add(gradient(16, 16));
  }
  EXPECT_EQ(folder.entryCount(), 0u);
}

TEST(Video, AnEncoderThatEndsIsAnErrorNotASignal) {
  const sample::Folder folder;
  VideoOptions options;
  options.encoder = "false";
  VideoWriter video(folder / "clip.mp4", 512, 512, options);
  EXPECT_THROW(
      {
        for (int f = 0; f < 20; ++f) video.add(gradient(512, 512));
        video.finish();
      },
      Error);
}

}  // namespace
}  // namespace fascia
