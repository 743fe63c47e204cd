// Where files go, and what is never written over.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fascia/base/error.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/file/file.h>
#include <fascia/io/file/inputs.h>
#include <fascia/io/file/temporary_file.h>
#include <fascia/io/file/unfinished.h>
#include <fascia/io/picture/video_writer.h>

#include "sample.h"

namespace fascia {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string refusalOf(const std::string& path) {
  try {
    writeFileWhole(path, "new");
  } catch (const Error& error) {
    return error.what();
  }
  return "written";
}

TEST(InputGuard, KeepsWhatHasBeenReadUnderAnyName) {
  const sample::Folder folder;
  writeFileWhole(folder / "a", "old");
  fs::create_symlink("a", folder / "soft");
  fs::create_hard_link(folder / "a", folder / "hard");
  fs::create_directory_symlink(folder.path(), folder / "around");
  const InputGuard guard;
  readFile(folder / "soft", 100);
  for (const char* name : {"a", "soft", "hard", "around/a", "./a"})
    EXPECT_THAT(refusalOf(folder / name), HasSubstr("would be overwritten")) << name;
  EXPECT_EQ(readFile(folder / "a", 100), "old");
  EXPECT_EQ(refusalOf(folder / "b"), "written");
}

TEST(InputGuard, LetsReadingWhatIsToBeWrittenFail) {
  const sample::Folder folder;
  writeFileWhole(folder / "a", "old");
  fs::create_hard_link(folder / "a", folder / "hard");
  const InputGuard guard;
  planOutputs({folder / "hard", folder / "missing"});
  EXPECT_THROW(readFile(folder / "a", 100), Error);
  EXPECT_THROW(planOutputs({folder / "a"}), Error);
}

TEST(InputGuard, IsForgottenWithItsEnd) {
  const sample::Folder folder;
  writeFileWhole(folder / "a", "old");
  {
    const InputGuard guard;
    readFile(folder / "a", 100);
  }
  EXPECT_EQ(refusalOf(folder / "a"), "written");
  readFile(folder / "a", 100);  // an editor saves what it has opened
  EXPECT_EQ(refusalOf(folder / "a"), "written");
}

TEST(WholeFile, WritesThroughLinks) {
  const sample::Folder folder;
  fs::create_directory(folder / "there");
  writeFileWhole(folder / "there/a", "old");
  fs::create_symlink("there/a", folder / "link");
  fs::create_symlink("link", folder / "linked");
  fs::create_symlink("there/b", folder / "dangling");
  fs::create_symlink("self", folder / "self");
  writeFileWhole(folder / "linked", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link") && fs::is_symlink(folder / "linked"));
  EXPECT_EQ(readFile(folder / "there/a", 100), "new");
  writeFileWhole(folder / "dangling", "b");
  EXPECT_EQ(readFile(folder / "there/b", 100), "b");
  EXPECT_THAT(refusalOf(folder / "self"), HasSubstr("leads to itself"));
}

TEST(WholeFile, KeepsPermissionsAndOtherNamesOfWhatItReplaces) {
  const sample::Folder folder;
  writeFileWhole(folder / "a", "old");
  chmod((folder / "a").c_str(), 0640);
  fs::create_hard_link(folder / "a", folder / "other");
  writeFileWhole(folder / "a", "new");
  struct stat info {};
  ASSERT_EQ(stat((folder / "a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
  EXPECT_EQ(readFile(folder / "other", 100), "old");
}

TEST(WholeFile, ReplacesNoDeviceAndWaitsForNoReader) {
  const sample::Folder folder;
  fs::create_symlink("/dev/null", folder / "nothing");
  fs::create_symlink("/dev/full", folder / "full");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(refusalOf(folder / "nothing"), "written");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT(refusalOf(folder / "full"), HasSubstr("No space left"));
  EXPECT_THAT(refusalOf(folder / "pipe"), HasSubstr("cannot be written"));
  EXPECT_THROW(TemporaryFile(folder / "pipe"), Error);
}

TEST(WholeFile, TooLargeAFileIsAnError) {
  const sample::Folder folder;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string told = "written";
  try {
    writeFileWhole(folder / "a", std::string(100'000, 'x'));
  } catch (const Error& error) {
    told = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(told, HasSubstr("File too large"));
  EXPECT_EQ(folder.entryCount(), 0u);
}

TEST(Temporaries, HaveNamesThatNobodyElseHas) {
  EXPECT_NE(temporaryName("a"), temporaryName("a"));
  EXPECT_TRUE(temporaryName("").starts_with(".fascia-"));
}

// What a killed run leaves where files cannot be without a name.
TEST(Temporaries, OfDeadRunsAreSweptAndNothingElse) {
  const sample::Folder folder;
  const std::string dead = folder / ".fascia-999999999-0123456789abcdef.tmp";
  const std::string deadFolder = folder / ".fascia-999999999-fedcba9876543210.tmp";
  writeFileWhole(dead, "half");
  fs::create_directory(deadFolder);
  writeFileWhole(deadFolder + "/00000.png", "half");
  writeFileWhole(folder / ".fascia-mine.tmp", "a person's");
  writeFileWhole(folder / "o.mp4.tmp", "a person's");
  fs::create_directory(folder / "o.tmp");
  sweepTemporaries(folder / "");
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_FALSE(fs::exists(deadFolder));
  EXPECT_EQ(folder.entryCount(), 3u);
}

TEST(Temporaries, OfLivingRunsStay) {
  const sample::Folder folder;
  const std::string held = folder / ".fascia-1-0123456789abcdef.tmp";
  writeFileWhole(held, "half");
  sweepTemporaries(folder / "");
  EXPECT_TRUE(fs::exists(held)) << "its maker lives";
}

TEST(Temporaries, AFolderKeepsWhatWeDidNotWrite) {
  const sample::Folder folder;
  fs::create_directory(folder / "film");
  writeFileWhole(folder / "film/00001.png", "ours");
  writeFileWhole(folder / "film/notes.txt", "a person's");
  removeOwnFolder(folder / "film");
  EXPECT_FALSE(fs::exists(folder / "film/00001.png"));
  EXPECT_TRUE(fs::exists(folder / "film/notes.txt"));
}

TEST(PictureSequence, TakesNoPlaceThatIsTaken) {
  const sample::Folder folder;
  const VideoOptions options{.encoder = "no-such-encoder"};
  const Image frame{2, 2, std::vector<std::uint8_t>(16, 200)};
  fs::create_directory(folder / "a.tmp");
  writeFileWhole(folder / "a.tmp/mine", "a person's");
  {
    VideoWriter video(folder / "a.mp4", 2, 2, options);
    video.add(frame);
    fs::create_directory(folder / "a");  // meanwhile
    EXPECT_THROW(video.finish(), Error);
  }
  EXPECT_TRUE(fs::is_empty(folder / "a"));
  EXPECT_TRUE(fs::exists(folder / "a.tmp/mine"));
  EXPECT_EQ(folder.entryCount(), 2u);
  EXPECT_THROW(VideoWriter(folder / "a.mp4", 2, 2, options), Error);
}

TEST(Video, TwoIntoOneFileAtOnceAreBothWhole) {
  if (findProgram("ffmpeg").empty()) GTEST_SKIP() << "ffmpeg is not installed";
  const sample::Folder folder;
  writeFileWhole(folder / "a.mp4.tmp", "a person's");
  VideoWriter first(folder / "a.mp4", 16, 16), second(folder / "a.mp4", 16, 16);
  const Image frame{16, 16, std::vector<std::uint8_t>(1024, 200)};
  for (int f = 0; f < 5; ++f) first.add(frame), second.add(frame);
  first.finish();
  const std::string one = readFile(folder / "a.mp4", 1 << 20);
  second.finish();
  EXPECT_THAT(one, HasSubstr("moov"));
  EXPECT_EQ(readFile(folder / "a.mp4", 1 << 20), one);
  EXPECT_EQ(readFile(folder / "a.mp4.tmp", 100), "a person's");
  EXPECT_EQ(folder.entryCount(), 2u);
}

TEST(Forked, WorkThatHangsIsEnded) {
  const auto hang = [](int) -> bool {
    for (;;) pause();
  };
  const ForkResult result = runForked(hang, 100, 0.2);
  EXPECT_TRUE(result.tooLong);
  EXPECT_FALSE(result.succeeded);
}

TEST(Forked, WorkTellsWhatItFound) {
  const auto tell = [](int out) { return ::write(out, "found", 5) == 5; };
  const ForkResult result = runForked(tell, 100, 60);
  EXPECT_EQ(result.bytes, "found");
  EXPECT_TRUE(result.succeeded);
  EXPECT_FALSE(result.tooLong);
}

}  // namespace
}  // namespace fascia
