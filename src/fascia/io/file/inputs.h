#pragma once

#include <compare>
#include <optional>
#include <string>
#include <vector>

#include <sys/stat.h>

namespace fascia {

// While one of these lives, nothing that is read is written over: every file that is read is
// remembered as what it is (device and inode), so that links and other names of it are known, and
// whatever would write there throws Error. For programs that read some files to write others; an
// editor, which saves what it has opened, has none. Of all that live at once, there is one memory.
class InputGuard {
 public:
  InputGuard();
  ~InputGuard();
  InputGuard(const InputGuard&) = delete;
  InputGuard& operator=(const InputGuard&) = delete;
};

// What a file is, whatever it is called.
struct FileId {
  dev_t device;
  ino_t inode;
  bool operator==(const FileId&) const = default;
  auto operator<=>(const FileId&) const = default;
};

std::optional<FileId> fileIdOf(const std::string& path);  // none: nothing is there

// Remembers an open file that is read, or one that is named by what is read and might be. Throw
// Error if it is planned to be written. Without a guard they do nothing.
void noteInput(const std::string& path, const struct stat& info);
void noteInput(const std::string& path);
void noteInput(FileId id);

// What is going to be written: throws Error if one of these files has been read, and lets reading
// one of them throw from now on, before any long work.
void planOutputs(const std::vector<std::string>& paths);
void refuseInput(const std::string& path);  // throws Error if it has been read

std::vector<FileId> notedInputs();

// For forking: nobody else is amid a change of the memory while the child is made.
void lockInputs();
void unlockInputs();

}  // namespace fascia
