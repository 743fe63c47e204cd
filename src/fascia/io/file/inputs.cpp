#include <fascia/io/file/inputs.h>

#include <mutex>
#include <set>

#include <fascia/base/error.h>

namespace fascia {
namespace {

struct InputMemory {
  std::mutex mutex;
  int guards = 0;
  std::set<FileId> inputs, outputs;
};

InputMemory& inputMemory() {
  static InputMemory memory;
  return memory;
}

[[noreturn]] void refuseOverwriting(const std::string& path) {
  throw fileError(path, "is read for this, and would be overwritten", "choose another name");
}

// Whether it is planned as an output.
bool remember(FileId id) {
  InputMemory& memory = inputMemory();
  const std::lock_guard lock(memory.mutex);
  if (memory.guards == 0) return false;
  memory.inputs.insert(id);
  return memory.outputs.contains(id);
}

}  // namespace

std::optional<FileId> fileIdOf(const std::string& path) {
  struct stat info {};
  if (path.empty() || stat(path.c_str(), &info) != 0) return std::nullopt;
  return FileId{info.st_dev, info.st_ino};
}

InputGuard::InputGuard() {
  const std::lock_guard lock(inputMemory().mutex);
  ++inputMemory().guards;
}

InputGuard::~InputGuard() {
  InputMemory& memory = inputMemory();
  const std::lock_guard lock(memory.mutex);
  if (--memory.guards > 0) return;
  memory.inputs.clear();
  memory.outputs.clear();
}

void noteInput(const std::string& path, const struct stat& info) {
  // Devices and pipes hold nothing that could be lost.
  if (S_ISREG(info.st_mode) && remember({info.st_dev, info.st_ino})) refuseOverwriting(path);
}

void noteInput(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) == 0) noteInput(path, info);
}

void noteInput(FileId id) {
  remember(id);
}

void planOutputs(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    refuseInput(path);
    const std::optional<FileId> id = fileIdOf(path);
    InputMemory& memory = inputMemory();
    const std::lock_guard lock(memory.mutex);
    if (id && memory.guards > 0) memory.outputs.insert(*id);
  }
}

void refuseInput(const std::string& path) {
  const std::optional<FileId> id = fileIdOf(path);
  InputMemory& memory = inputMemory();
  std::unique_lock lock(memory.mutex);
  const bool input = id && memory.inputs.contains(*id);
  lock.unlock();
  if (input) refuseOverwriting(path);
}

std::vector<FileId> notedInputs() {
  InputMemory& memory = inputMemory();
  const std::lock_guard lock(memory.mutex);
  return {memory.inputs.begin(), memory.inputs.end()};
}

void lockInputs() {
  inputMemory().mutex.lock();
}

void unlockInputs() {
  inputMemory().mutex.unlock();
}

}  // namespace fascia
