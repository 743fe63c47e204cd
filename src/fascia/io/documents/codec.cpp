#include <fascia/io/documents/codec.h>

namespace fascia {

std::string JsonPath::text() const {
  if (!parent) return {};
  return parent->text() + '/' + (isIndex ? std::to_string(index) : escapedPointerKey(key));
}

void Reading::fault(const Json& at, const JsonPath& path, std::string message, std::string hint) {
  constexpr std::size_t kEnough = 200;  // a person reads no more; a hostile file has millions
  if (issues.size() >= kEnough) return;
  issues.push_back({{{}, at.line(), path.text()}, std::move(message), std::move(hint)});
}

void Reading::unexpected(const Json& at, const JsonPath& path, const std::string& expected) {
  fault(at, path, "found " + described(at) + ", expected " + expected);
}

bool Reading::expect(const Json& at, Json::Kind kind, const JsonPath& path) {
  if (at.is(kind)) return true;
  static const char* const kNames[] = {"null",   "true or false", "a number",
                                       "a text", "a list",        "an object"};
  unexpected(at, path, kNames[static_cast<std::size_t>(kind)]);
  return false;
}

std::string shown(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  return text.size() > kLongest ? jsonText(text.substr(0, kLongest)) + "…" : jsonText(text);
}

std::string described(const Json& value) {
  switch (value.kind()) {
    case Json::Kind::null:
      return "null";
    case Json::Kind::boolean:
      return value.boolean() ? "true" : "false";
    case Json::Kind::number:
      return value.digits().substr(0, 40);
    case Json::Kind::text:
      return "the text " + shown(value.text());
    case Json::Kind::list:
      return "a list of " + std::to_string(value.list().size());
    case Json::Kind::object:
      return "an object";
  }
  return {};
}

}  // namespace fascia
