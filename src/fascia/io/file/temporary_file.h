#pragma once

#include <string>

namespace fascia {

// A new file that becomes `target` in one step, or nothing. Until then it has no name at all
// (O_TMPFILE); where the file system cannot do that, a name that nobody else has, beside the
// target, which is removed however the program ends (see unfinished.h). Links at `target` are
// followed: what they lead to is written, and they stay.
class TemporaryFile {
 public:
  // Throws Error if nothing can be written there: no such folder, a folder in the way, a file that
  // is read for this (see inputs.h).
  explicit TemporaryFile(std::string target);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return descriptor_; }
  void put();  // throws Error; a file that was there is replaced, its permissions are kept

 private:
  void open(const std::string& folder);
  void keepPermissions() const;
  void putUnnamed();
  [[noreturn]] void fail(const char* what) const;

  std::string shown_, target_;  // as a person named it; at the end of all links
  std::string name_;            // empty: it has none
  int descriptor_ = -1;
};

// Where a chain of links ends, whether or not anything is there.
std::string endOfLinks(const std::string& path);

}  // namespace fascia
