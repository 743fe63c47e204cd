#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace fascia {

// A folder in memory for parsers that are given paths; the same in every call, gone at the end.
class Scratch {
 public:
  Scratch() {
    std::string name = "/dev/shm/fascia_fuzz_XXXXXX";
    if (!mkdtemp(name.data())) std::abort();
    folder_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path path = folder_ / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path.string();
  }

 private:
  std::filesystem::path folder_;
};

// Takes the part of an input up to a line of three dashes: one input, several files.
inline std::string_view nextPart(std::string_view& bytes) {
  constexpr std::string_view kEnd = "\n---\n";
  const std::size_t end = bytes.find(kEnd);
  const std::string_view part = bytes.substr(0, end);
  bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + kEnd.size());
  return part;
}

inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace fascia
