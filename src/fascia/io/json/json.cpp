#include <fascia/io/json/json.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace fascia {
namespace {

template <class T>
std::string digitsOf(T value) {
  if (!std::isfinite(value)) throw Error("a value is not a finite number and cannot be written");
  if (value == 0 && std::signbit(value)) return "-0.0";  // "-0" would be read as an integer
  char buffer[48];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  std::string digits(buffer, end);
  const std::size_t exponent = digits.find('e');  // "1e+06": people write 1e6
  if (exponent != std::string::npos) {
    if (digits[exponent + 1] == '+') digits.erase(exponent + 1, 1);
    const std::size_t first = digits.find_first_of("123456789", exponent + 1);
    const std::size_t sign = digits[exponent + 1] == '-' ? 2 : 1;
    digits.erase(exponent + sign, first - exponent - sign);
  }
  return digits;
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
