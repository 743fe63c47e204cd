#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <fascia/io/json/json.h>

namespace fascia {

// A place in a glTF's JSON, present or not, with its pointer: reading through it checks what is
// found and throws Error that says where. Lives no longer than the JSON.
class GltfPlace {
 public:
  GltfPlace(const Json* value, std::string pointer, const std::string& file)
      : value_(value), pointer_(std::move(pointer)), file_(&file) {}

  explicit operator bool() const { return value_ != nullptr; }
  const Json* json() const { return value_; }
  const std::string& pointer() const { return pointer_; }
  const std::string& file() const { return *file_; }

  GltfPlace operator[](std::string_view key) const;  // absent if there is no such member
  GltfPlace at(std::size_t index) const;             // an item that must be there
  std::size_t size() const;                          // of a list; 0 if absent

  // Absent: the fallback; the versions without one throw.
  int index(int limit) const;  // in [0, limit)
  int indexOr(int fallback, int limit) const { return value_ ? index(limit) : fallback; }
  std::size_t count() const;  // a non-negative integer
  std::size_t countOr(std::size_t fallback) const { return value_ ? count() : fallback; }
  double numberOr(double fallback) const;
  std::string text() const;
  std::string textOr(std::string_view fallback) const;
  bool flagOr(bool fallback) const;
  void numbers(double* out, std::size_t count) const;  // a list of just so many; absent: untouched

  [[noreturn]] void fail(const std::string& message, const std::string& hint = {}) const;

 private:
  [[noreturn]] void expected(const std::string& what) const;

  const Json* value_;
  std::string pointer_;
  const std::string* file_;
};

}  // namespace fascia
