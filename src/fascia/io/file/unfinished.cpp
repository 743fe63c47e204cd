#include <fascia/io/file/unfinished.h>

#include <cctype>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <random>
#include <set>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

namespace fascia {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTemporaryStart = ".fascia-", kTemporaryEnd = ".tmp";
constexpr std::size_t kRandomDigits = 16;
// A temporary that is being made has no lock for a moment.
constexpr std::time_t kSettled_s = 60;

struct UnfinishedWork {
  std::mutex mutex;
  std::set<std::string> temporaries, swept;
  std::set<pid_t> children;
};

// Never destroyed: a signal may come while the program ends.
UnfinishedWork& unfinished() {
  static UnfinishedWork& work = *new UnfinishedWork;
  return work;
}

// The process in ".fascia-PID-RANDOM.tmp"; 0 for any other name.
pid_t makerOf(std::string_view name) {
  if (!name.starts_with(kTemporaryStart) || !name.ends_with(kTemporaryEnd)) return 0;
  name = name.substr(kTemporaryStart.size());
  name.remove_suffix(kTemporaryEnd.size());
  pid_t maker = 0;
  const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), maker);
  const std::string_view random(end, static_cast<std::size_t>(name.data() + name.size() - end));
  if (fault != std::errc() || maker <= 0 || random.size() != kRandomDigits + 1 || random[0] != '-')
    return 0;
  for (const char c : random.substr(1))
    if (!std::isxdigit(static_cast<unsigned char>(c))) return 0;
  return maker;
}

bool isNumberedPicture(const std::string& name) {
  if (name.size() < 9 || !name.ends_with(".png")) return false;
  for (const char c : name.substr(0, name.size() - 4))
    if (!std::isdigit(static_cast<unsigned char>(c))) return false;
  return true;
}

void removeTemporary(const std::string& path) {
  if (unlink(path.c_str()) != 0 && (errno == EISDIR || errno == EPERM)) removeOwnFolder(path);
}

// Whether nobody works on it any more. Its lock is free then, and its maker gone or long past the
// moment between making and locking.
bool isLeftOver(const std::string& path, pid_t maker) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return false;
  struct stat info {};
  const bool ours = fstat(descriptor, &info) == 0 && info.st_uid == geteuid() &&
                    (S_ISREG(info.st_mode) || S_ISDIR(info.st_mode));
  const bool unlocked = ours && flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  close(descriptor);
  const bool gone = kill(maker, 0) != 0 && errno == ESRCH;
  return unlocked && (gone || std::time(nullptr) - info.st_ctime > kSettled_s);
}

}  // namespace

std::unique_lock<std::mutex> lockUnfinished() {
  return std::unique_lock(unfinished().mutex);
}

void listTemporary(const std::string& path) {
  unfinished().temporaries.insert(path);
}
void unlistTemporary(const std::string& path) {
  unfinished().temporaries.erase(path);
}
void listChild(pid_t child) {
  unfinished().children.insert(child);
}
void unlistChild(pid_t child) {
  unfinished().children.erase(child);
}

void abandonUnfinished() {
  UnfinishedWork& work = unfinished();
  work.mutex.lock();
  for (const pid_t child : work.children) kill(child, SIGKILL);
  for (const std::string& path : work.temporaries) removeTemporary(path);
}

void removeOwnFolder(const std::string& path) {
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, fault)) {
    const std::string name = entry.path().filename().string();
    if (isNumberedPicture(name) || makerOf(name) != 0) unlink(entry.path().c_str());
  }
  rmdir(path.c_str());
}

std::string temporaryName(const std::string& folder) {
  unsigned long long random = 0;
  if (getrandom(&random, sizeof random, 0) != static_cast<ssize_t>(sizeof random))
    random = std::random_device{}() | 1ULL * std::random_device{}() << 32;
  char digits[kRandomDigits + 1];
  std::snprintf(digits, sizeof digits, "%016llx", random);
  std::string path = folder.empty() ? std::string() : folder.ends_with('/') ? folder : folder + "/";
  path.append(kTemporaryStart).append(std::to_string(getpid())).append("-").append(digits);
  return path.append(kTemporaryEnd);
}

void sweepTemporaries(const std::string& folder) {
  {
    const auto lock = lockUnfinished();
    if (!unfinished().swept.insert(folder).second) return;
  }
  std::error_code fault;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder.empty() ? "." : folder, fault)) {
    const pid_t maker = makerOf(entry.path().filename().string());
    if (maker == 0) continue;
    if (isLeftOver(entry.path().string(), maker)) removeTemporary(entry.path().string());
  }
}

}  // namespace fascia
