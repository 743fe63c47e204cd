#pragma once

#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fascia/base/error.h>

namespace fascia {

// A JSON value that remembers the line it was read from. Numbers keep their digits as text, so that
// nothing is lost on the way; members keep their order.
class Json {
 public:
  struct Member;
  using List = std::vector<Json>;
  using Object = std::vector<Member>;
  struct Number {
    std::string digits;
  };
  enum class Kind { null, boolean, number, text, list, object };

  // Defined below: Member must be complete.
  Json();
  Json(bool value);    // NOLINT: values convert
  Json(double value);  // NOLINT: shortest digits
  Json(int value);     // NOLINT
  template <std::unsigned_integral T>
  requires(!std::same_as<T, bool>) Json(T value);  // NOLINT
  Json(Number value);                              // NOLINT
  Json(std::string value);                         // NOLINT
  Json(std::string_view value);                    // NOLINT
  Json(const char* value);                         // NOLINT
  Json(List value);                                // NOLINT
  Json(Object value);                              // NOLINT
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(const Json& other);
  Json& operator=(Json&& other) noexcept;
  ~Json();

  Kind kind() const { return static_cast<Kind>(value_.index()); }
  bool is(Kind k) const { return kind() == k; }
  int line() const { return line_; }
  void setLine(int line) { line_ = line; }

  // Only for the matching kind.
  bool boolean() const { return std::get<bool>(value_); }
  const std::string& digits() const { return std::get<Number>(value_).digits; }
  double number() const;
  const std::string& text() const { return std::get<std::string>(value_); }
  const List& list() const { return std::get<List>(value_); }
  List& list() { return std::get<List>(value_); }
  const Object& object() const { return std::get<Object>(value_); }
  Object& object() { return std::get<Object>(value_); }

  const Json* find(std::string_view key) const;  // nullptr: no object, or no such member
  void set(std::string key, Json value);         // appends a member; the key must be new

 private:
  std::variant<std::monostate, bool, Number, std::string, List, Object> value_;
  int line_ = 0;
};

struct Json::Member {
  std::string key;
  Json value;
};

inline Json::Json() = default;
inline Json::Json(bool value) : value_(value) {}
inline Json::Json(int value) : value_(Number{std::to_string(value)}) {}
template <std::unsigned_integral T>
requires(!std::same_as<T, bool>) Json::Json(T value) : value_(Number{std::to_string(value)}) {}
inline Json::Json(Number value) : value_(std::move(value)) {}
inline Json::Json(std::string value) : value_(std::move(value)) {}
inline Json::Json(std::string_view value) : value_(std::string(value)) {}
inline Json::Json(const char* value) : value_(std::string(value)) {}
inline Json::Json(List value) : value_(std::move(value)) {}
inline Json::Json(Object value) : value_(std::move(value)) {}
inline Json::Json(const Json& other) = default;
inline Json::Json(Json&& other) noexcept = default;
inline Json& Json::operator=(const Json& other) = default;
inline Json& Json::operator=(Json&& other) noexcept = default;
inline Json::~Json() = default;

// What a stranger's file may cost us: beyond these it is refused.
struct JsonLimits {
  std::size_t bytes = 64u << 20;   // of text
  std::size_t values = 2'000'000;  // ~50 bytes each in memory; per-point data are texts, not values
  int depth = 32;                  // our deepest is 7; readers recurse this deep
};

// Strict JSON (RFC 8259): no comments, no duplicate keys, nothing after the value, valid UTF-8.
// Reports to `diagnostics` with lines; the result is usable only if it stayed ok.
Json parseJson(std::string_view text, const JsonLimits& limits, std::vector<Issue>& issues);

// Indented by two; lists of plain values and small objects on one line of at most 100 characters
// (lists of numbers always on one line). Ends with a newline.
std::string printJson(const Json& value);
std::string compactJson(const Json& value);  // without spaces, on one line

// Shortest digits that read back to the same bits. Throws Error for NaN and infinities, which JSON
// cannot hold.
std::string shortestDigits(double value);
std::string shortestDigits(float value);

std::string jsonText(std::string_view text);          // quoted and escaped as JSON wants it
std::string escapedPointerKey(std::string_view key);  // "a/b" -> "a~1b" (RFC 6901)

// Numbers of one kind as a list; floats by digits that read back to the same float.
template <class Values>
Json numberList(const Values& values) {
  Json::List list;
  for (const auto value : values) {
    if constexpr (std::same_as<decltype(value), const float>)
      list.emplace_back(Json::Number{shortestDigits(value)});
    else
      list.emplace_back(value);
  }
  return list;
}

// Editing. Each finds the member of an object (null becomes one), made if it is missing.
Json* findMember(Json& object, std::string_view key);  // nullptr: no object, or no such member
Json& ensureMember(Json& object, std::string_view key);
Json& ensureList(Json& object, std::string_view key);
void putMember(Json& object, std::string_view key, Json value);
void eraseMember(Json& object, std::string_view key);

}  // namespace fascia
