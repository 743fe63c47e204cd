#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace fascia {

// 64-bit FNV-1a over the bits of a state: two runs agree exactly when their hashes do.
class StateHash {
 public:
  void add(const void* data, std::size_t bytes);
  template <class T>
  void add(const T& value) {
    add(&value, sizeof value);
  }
  std::uint64_t value() const { return hash_; }
  std::string hex() const;  // 16 lower-case digits

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ull;
};

}  // namespace fascia
