#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace fascia {

// The whole file. Throws Error: missing, a folder or device, unreadable, larger than maxBytes.
std::string readFile(const std::string& path, std::size_t maxBytes);

std::string folderOf(const std::string& path);  // "a/b.json" -> "a"; empty = the current one

// A file that appears whole or not at all: written under a temporary name beside its place, renamed
// by commit(), removed if that never comes.
class WholeFile {
 public:
  explicit WholeFile(std::string path);  // throws Error if the folder cannot be written to
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* data, std::size_t bytes);  // throws Error: disk full, …
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();  // throws Error; the old file, if any, is replaced in one step

 private:
  [[noreturn]] void fail(const char* what);

  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
};

void writeFileWhole(const std::string& path, std::string_view bytes);

}  // namespace fascia
