#include <fascia/io/file/temporary_file.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fascia/base/error.h>
#include <fascia/io/file/file.h>
#include <fascia/io/file/inputs.h>
#include <fascia/io/file/unfinished.h>

namespace fascia {
namespace {

constexpr int kMostLinks = 40;  // as Linux follows

}  // namespace

std::string endOfLinks(const std::string& path) {
  namespace fs = std::filesystem;
  fs::path at = path;
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code fault;
    const fs::path next = fs::read_symlink(at, fault);
    if (fault) return at.string();
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  throw fileError(path, "is a link that leads to itself");
}

TemporaryFile::TemporaryFile(std::string target)
    : shown_(std::move(target)), target_(endOfLinks(shown_)) {
  struct stat info {};
  if (stat(target_.c_str(), &info) == 0) {
    if (S_ISDIR(info.st_mode)) throw fileError(shown_, "is a folder, expected a file name");
    if (!S_ISREG(info.st_mode)) throw fileError(shown_, "is not a regular file");
  }
  refuseInput(target_);
  open(folderOf(target_));
}

TemporaryFile::~TemporaryFile() {
  if (!name_.empty()) {
    const auto lock = lockUnfinished();
    unlink(name_.c_str());
    unlistTemporary(name_);
  }
  if (descriptor_ >= 0) close(descriptor_);
}

void TemporaryFile::open(const std::string& folder) {
  sweepTemporaries(folder);
  constexpr mode_t kMode = 0666;
  descriptor_ =
      ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, kMode);
  if (descriptor_ >= 0) return;
  const auto lock = lockUnfinished();
  const std::string name = temporaryName(folder);
  descriptor_ = ::open(name.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, kMode);
  if (descriptor_ < 0) fail("cannot be written");
  flock(descriptor_, LOCK_EX | LOCK_NB);
  name_ = name;
  listTemporary(name_);
}

void TemporaryFile::fail(const char* what) const {
  throw fileError(shown_, std::string(what) + ": " + std::strerror(errno));
}

void TemporaryFile::keepPermissions() const {
  constexpr mode_t kPermissions = 0777;
  struct stat before {};
  if (stat(target_.c_str(), &before) == 0) fchmod(descriptor_, before.st_mode & kPermissions);
}

// A file without a name can get a free one only; over another file it needs one in between.
void TemporaryFile::putUnnamed() {
  const std::string self = "/proc/self/fd/" + std::to_string(descriptor_);
  const auto give = [&](const std::string& name) {
    return linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  };
  if (give(target_)) return;
  if (errno != EEXIST) fail("cannot be put in its place");
  flock(descriptor_, LOCK_EX | LOCK_NB);
  const std::string name = temporaryName(folderOf(target_));
  if (!give(name)) fail("cannot be put in its place");
  if (std::rename(name.c_str(), target_.c_str()) == 0) return;
  const int fault = errno;
  unlink(name.c_str());
  errno = fault;
  fail("cannot be put in its place");
}

void TemporaryFile::put() {
  refuseInput(target_);
  keepPermissions();
  const auto lock = lockUnfinished();
  if (name_.empty()) {
    putUnnamed();
  } else {
    if (std::rename(name_.c_str(), target_.c_str()) != 0) fail("cannot be put in its place");
    unlistTemporary(name_);
    name_.clear();
  }
  close(descriptor_);
  descriptor_ = -1;
}

}  // namespace fascia
