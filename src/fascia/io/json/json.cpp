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

std::string unescapedPointerKey(std::string_view key) {
  std::string out;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const bool escape = key[i] == '~' && i + 1 < key.size();
    if (!escape) {
      out += key[i];
    } else {
      out += key[++i] == '1' ? '/' : '~';
    }
  }
  return out;
}

// The child of `value` that a pointer's part names, and the part as the file spells it.
const Json* child(const Json& value, const std::string& part, std::string& spelled) {
  spelled = part;
  if (value.is(Json::Kind::list)) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
    const bool whole = error == std::errc() && end == part.data() + part.size();
    return whole && index < value.list().size() ? &value.list()[index] : nullptr;
  }
  if (const Json* found = value.find(part)) return found;
  if (part.ends_with("_rad")) {
    spelled = part.substr(0, part.size() - 3) + "deg";
    return value.find(spelled);
  }
  return nullptr;
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

Location LineIndex::locate(std::string_view pointer) const {
  Location where{file_, 0, {}};
  if (!root_) {
    where.pointer = pointer;
    return where;
  }
  const Json* at = root_.get();
  where.line = at->line();
  std::string unmatched;  // trailing parts that the file lacks, e.g. a missing key
  while (!pointer.empty()) {
    pointer.remove_prefix(1);  // the slash
    const std::size_t end = std::min(pointer.find('/'), pointer.size());
    const std::string part = unescapedPointerKey(pointer.substr(0, end));
    pointer.remove_prefix(end);
    std::string spelled;
    if (const Json* next = child(*at, part, spelled)) {
      at = next;
      where.line = at->line();
      where.pointer += '/';
      where.pointer += escapedPointerKey(spelled);
      unmatched.clear();
    } else {
      unmatched += '/';
      unmatched += escapedPointerKey(spelled);
    }
  }
  where.pointer += unmatched;
  return where;
}

std::vector<Issue> LineIndex::locate(std::vector<Issue> issues) const {
  for (Issue& issue : issues) issue.where = locate(issue.where.pointer);
  return issues;
}

}  // namespace fascia
