#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace fascia {

// The whole file. Throws Error: missing, a folder or device, unreadable, larger than maxBytes.
std::string readFile(const std::string& path, std::size_t maxBytes);

// Without the mark that some editors put before UTF-8 (U+FEFF).
std::string_view withoutByteOrderMark(std::string_view text);

std::string folderOf(const std::string& path);  // "a/b.json" -> "a"; empty = the current one

// A file that appears whole or not at all (see TemporaryFile): commit() puts it in its place. Onto
// devices, pipes and what standard output already goes to, it is written as it comes.
class WholeFile {
 public:
  explicit WholeFile(std::string path);  // throws Error if it cannot be written there
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* data, std::size_t bytes);  // throws Error: disk full, …
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();  // throws Error; the old file, if any, is replaced in one step

 private:
  [[noreturn]] void fail(const char* what);

  std::string path_;
  std::unique_ptr<class TemporaryFile> temporary_;  // none of what is written as it comes
  std::FILE* file_ = nullptr;
};

void writeFileWhole(const std::string& path, std::string_view bytes);

}  // namespace fascia
