#include <fascia/io/json/json.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fascia/base/tunable.h>

namespace fascia {
namespace {

template <class T>
std::string digitsOf(T value) {
  if (!std::isfinite(value)) throw Error("a value is not a finite number and cannot be written");
  return shortestText(value);
}

}  // namespace

Json::Json(double value) : value_(Number{shortestDigits(value)}) {}

double Json::number() const {
  const std::string& text = digits();
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

const Json* Json::find(std::string_view key) const {
  if (!is(Kind::object)) return nullptr;
  for (const Member& member : object()) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

void Json::set(std::string key, Json value) {
  if (is(Kind::null)) value_ = Object{};
  object().push_back({std::move(key), std::move(value)});
}

std::string shortestDigits(double value) {
  return digitsOf(value);
}
std::string shortestDigits(float value) {
  return digitsOf(value);
}

std::string escapedPointerKey(std::string_view key) {
  std::string out;
  for (const char c : key) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

Json* findMember(Json& object, std::string_view key) {
  if (!object.is(Json::Kind::object)) return nullptr;
  for (Json::Member& member : object.object()) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

Json& ensureMember(Json& object, std::string_view key) {
  if (Json* found = findMember(object, key)) return *found;
  object.set(std::string(key), Json());
  return object.object().back().value;
}

Json& ensureList(Json& object, std::string_view key) {
  Json& member = ensureMember(object, key);
  if (!member.is(Json::Kind::list)) member = Json(Json::List{});
  return member;
}

void putMember(Json& object, std::string_view key, Json value) {
  ensureMember(object, key) = std::move(value);
}

void eraseMember(Json& object, std::string_view key) {
  if (!object.is(Json::Kind::object)) return;
  std::erase_if(object.object(), [&](const Json::Member& member) { return member.key == key; });
}

}  // namespace fascia
