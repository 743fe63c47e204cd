#include <fascia/io/gltf/gltf_place.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

std::string described(const Json* value) {
  if (!value) return "nothing";
  switch (value->kind()) {
    case Json::Kind::null:
      return "null";
    case Json::Kind::boolean:
      return value->boolean() ? "true" : "false";
    case Json::Kind::number:
      return value->digits().substr(0, 40);
    case Json::Kind::text:
      return jsonText(std::string_view(value->text()).substr(0, 60));
    case Json::Kind::list:
      return "a list of " + std::to_string(value->list().size());
    case Json::Kind::object:
      return "an object";
  }
  return {};
}

}  // namespace

void GltfPlace::fail(const std::string& message, const std::string& hint) const {
  Issue issue;
  issue.where.file = *file_;
  issue.where.line = value_ ? value_->line() : 0;
  issue.where.pointer = pointer_;
  issue.message = message;
  issue.hint = hint;
  throw Error(std::move(issue));
}

void GltfPlace::expected(const std::string& what) const {
  fail("found " + described(value_) + ", expected " + what);
}

GltfPlace GltfPlace::operator[](std::string_view key) const {
  if (value_ && !value_->is(Json::Kind::object)) expected("an object");
  std::string pointer = pointer_;
  pointer += '/';
  pointer += escapedPointerKey(key);
  return {value_ ? value_->find(key) : nullptr, std::move(pointer), *file_};
}

GltfPlace GltfPlace::at(std::size_t index) const {
  if (index >= size()) expected("at least " + std::to_string(index + 1) + " entries");
  std::string pointer = pointer_;
  pointer += '/';
  pointer += std::to_string(index);
  return {&value_->list()[index], std::move(pointer), *file_};
}

std::size_t GltfPlace::size() const {
  if (!value_) return 0;
  if (!value_->is(Json::Kind::list)) expected("a list");
  return value_->list().size();
}

int GltfPlace::index(int limit) const {
  const double value = numberOr(-1);
  if (!(value >= 0 && value < limit && value == std::floor(value))) {
    expected(limit > 0 ? "an index in [0, " + std::to_string(limit - 1) + "]"
                       : std::string("no index: there is nothing to point at"));
  }
  return static_cast<int>(value);
}

std::size_t GltfPlace::count() const {
  constexpr double kMost = 9007199254740992.0;  // integers are exact up to 2^53
  const double value = numberOr(-1);
  if (!(value >= 0 && value <= kMost && value == std::floor(value))) {
    expected("an integer that is not negative");
  }
  return static_cast<std::size_t>(value);
}

double GltfPlace::numberOr(double fallback) const {
  if (!value_) return fallback;
  if (!value_->is(Json::Kind::number)) expected("a number");
  return value_->number();
}

std::string GltfPlace::text() const {
  if (!value_ || !value_->is(Json::Kind::text)) expected("a text");
  return value_->text();
}

std::string GltfPlace::textOr(std::string_view fallback) const {
  return value_ ? text() : std::string(fallback);
}

bool GltfPlace::flagOr(bool fallback) const {
  if (!value_) return fallback;
  if (!value_->is(Json::Kind::boolean)) expected("true or false");
  return value_->boolean();
}

void GltfPlace::numbers(double* out, std::size_t count) const {
  if (!value_) return;
  if (size() != count) expected("a list of " + std::to_string(count) + " numbers");
  for (std::size_t i = 0; i < count; ++i) out[i] = at(i).numberOr(0);
}

}  // namespace fascia
