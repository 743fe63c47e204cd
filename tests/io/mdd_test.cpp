#include <fascia/io/cache/mdd.h>

#include <gtest/gtest.h>

#include <cmath>

#include <fascia/io/file/file.h>

#include "sample.h"

namespace fascia {
namespace {

Recording twoFrames() {
  Recording recording;
  recording.skin.positions.assign(3, Eigen::Vector3f::Zero());
  for (const double t : {0.0, 0.25}) {
    Recording::Frame& frame = recording.frames.emplace_back();
    frame.time_s = t;
    for (int i = 0; i < 3; ++i) {
      frame.skin_m.emplace_back(static_cast<float>(i), static_cast<float>(t), -1e-7f);
    }
  }
  return recording;
}

std::string written() {
  const sample::Folder folder;
  writeMdd(twoFrames(), folder / "a.mdd");
  return readFile(folder / "a.mdd", 1000);
}

TEST(Mdd, ReadsBackToTheBit) {
  const Recording recording = twoFrames();
  const MddCache cache = parseMdd(written());
  EXPECT_EQ(cache.times_s, (std::vector<float>{0, 0.25f}));
  ASSERT_EQ(cache.pointCount, 3u);
  ASSERT_EQ(cache.positions_m.size(), 6u);
  for (std::size_t f = 0; f < 2; ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(cache.positions_m[3 * f + i], recording.frames[f].skin_m[i]);
    }
  }
}

TEST(Mdd, IsBigEndian) {
  EXPECT_EQ(written().substr(0, 8), std::string("\0\0\0\2\0\0\0\3", 8));
  // 0.25 is 0x3e800000.
  EXPECT_EQ(written().substr(12, 4), std::string("\x3e\x80\0\0", 4));
}

TEST(Mdd, CutFilesAreRefused) {
  const std::string whole = written();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THROW(parseMdd(whole.substr(0, length)), Error) << length;
  }
  EXPECT_THROW(parseMdd(whole + "x"), Error);
}

TEST(Mdd, AbsurdCountsAllocateNothing) {
  EXPECT_THROW(parseMdd(std::string("\xff\xff\xff\xff\0\0\0\1", 8)), Error);
  EXPECT_THROW(parseMdd(std::string("\x7f\xff\xff\xff\x7f\xff\xff\xff", 8)), Error);
  EXPECT_THROW(parseMdd(std::string("\0\0\0\0\x7f\xff\xff\xff", 8) + "left"), Error);
}

TEST(Mdd, FramesWithoutASkinLeaveNoFile) {
  const sample::Folder folder;
  Recording recording = twoFrames();
  recording.frames[1].skin_m.pop_back();
  EXPECT_THROW(writeMdd(recording, folder / "a.mdd"), Error);
  EXPECT_EQ(folder.entryCount(), 0u);
}

}  // namespace
}  // namespace fascia
