#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fascia/base/error.h>

namespace fascia {

static_assert(std::endian::native == std::endian::little, "binary formats are written as they lie");

// Appends plain values to a binary file's text.
class ByteWriter {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  template <class T>
  void array(const T* data, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(data), count * sizeof(T));
  }
  template <class T>
  void list(const std::vector<T>& values) {  // how many, then they
    value(static_cast<std::uint64_t>(values.size()));
    array(values.data(), values.size());
  }
  void text(std::string_view t) {
    value(static_cast<std::uint64_t>(t.size()));
    bytes.append(t);
  }

  std::string bytes;
};

// Takes them back; every read is checked against what is left, so that no count in a hostile file
// makes us allocate more than the file's own size.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, std::string file) : left_(bytes), file_(std::move(file)) {}

  template <class T>
  T value() {
    static_assert(std::is_trivially_copyable_v<T>);
    T v;
    std::memcpy(&v, take(sizeof v).data(), sizeof v);
    return v;
  }
  template <class T, class Allocator>
  void array(std::vector<T, Allocator>& out, std::uint64_t count) {
    if (count > left_.size() / sizeof(T)) fail("is cut short");
    const std::string_view part = take(static_cast<std::size_t>(count) * sizeof(T));
    out.resize(static_cast<std::size_t>(count));
    if (count > 0) std::memcpy(static_cast<void*>(out.data()), part.data(), part.size());
  }
  template <class T>
  void list(std::vector<T>& out) {
    array(out, value<std::uint64_t>());
  }
  std::string text() {
    const auto size = value<std::uint64_t>();
    if (size > left_.size()) fail("is cut short");
    return std::string(take(static_cast<std::size_t>(size)));
  }
  std::string_view take(std::size_t count) {
    if (count > left_.size()) fail("is cut short");
    const std::string_view part = left_.substr(0, count);
    left_.remove_prefix(count);
    return part;
  }
  std::size_t left() const { return left_.size(); }

  [[noreturn]] void fail(const std::string& message) const {
    Issue issue;
    issue.where.file = file_;
    issue.message = message;
    throw Error(std::move(issue));
  }

 private:
  std::string_view left_;
  std::string file_;
};

}  // namespace fascia
