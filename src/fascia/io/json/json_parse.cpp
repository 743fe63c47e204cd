// The only place that uses nlohmann's parser: its events build our Json, with lines.
#include <algorithm>
#include <iterator>
#include <unordered_set>

#include <nlohmann/json.hpp>

#include <fascia/io/json/json.h>

namespace fascia {
namespace {

// Counts lines while the parser reads.
struct Position {
  int line = 1;
  bool lastWasNewline = false;
};

class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, Position* position) : at_(at), position_(position) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    position_->lastWasNewline = *at_ == '\n';
    position_->line += position_->lastWasNewline ? 1 : 0;
    ++at_;
    return *this;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  Position* position_;
};

class Builder {
 public:
  Builder(const JsonLimits& limits, const Position& position, std::vector<Issue>& issues)
      : limits_(limits), position_(position), issues_(issues) {}

  Json take() { return std::move(root_); }

  bool null() { return add(Json(), position_.line); }
  bool boolean(bool value) { return add(Json(value), position_.line); }
  bool number_integer(std::int64_t value) { return addNumber(std::to_string(value)); }
  bool number_unsigned(std::uint64_t value) { return addNumber(std::to_string(value)); }
  bool number_float(double, const std::string& digits) { return addNumber(digits); }
  bool string(std::string& value) { return add(Json(std::move(value)), position_.line); }
  bool binary(nlohmann::json::binary_t&) { return false; }

  bool start_object(std::size_t) { return open(Json(Json::Object{})); }
  bool start_array(std::size_t) { return open(Json(Json::List{})); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    Level& level = stack_.back();
    if (!level.keys.insert(name).second) {
      issue("the key " + jsonText(name) + " appears twice in one object",
            pointer() + '/' + escapedPointerKey(name), "remove one of the two");
    }
    level.key = std::move(name);
    return true;
  }

  template <class Exception>
  bool parse_error(std::size_t, const std::string&, const Exception& exception) {
    std::string message =
        exception.what();  // "[json.exception…] parse error at line 1, column 2: …"
    const std::size_t bracket = message.find("] ");
    if (bracket != std::string::npos) message.erase(0, bracket + 2);
    issue(message, pointer(), "");
    return false;
  }

 private:
  struct Level {
    Json value;
    std::string key;  // of the member being read
    std::unordered_set<std::string> keys;
  };

  // The lexer has read one character past a number.
  bool addNumber(std::string digits) {
    return add(Json(Json::Number{std::move(digits)}),
               position_.line - (position_.lastWasNewline ? 1 : 0));
  }

  bool countOne() {
    if (++count_ <= limits_.values) return true;
    issue("more than " + std::to_string(limits_.values) + " values in one file", pointer(), "");
    return false;
  }

  bool add(Json value, int line) {
    if (!countOne()) return false;
    value.setLine(line);
    place(std::move(value));
    return true;
  }

  void place(Json value) {
    if (stack_.empty()) {
      root_ = std::move(value);
      return;
    }
    Level& level = stack_.back();
    if (level.value.is(Json::Kind::list)) {
      level.value.list().push_back(std::move(value));
    } else {
      level.value.object().push_back({std::move(level.key), std::move(value)});
    }
  }

  bool open(Json value) {
    if (static_cast<int>(stack_.size()) >= limits_.depth) {
      issue("nested more than " + std::to_string(limits_.depth) + " levels deep", pointer(), "");
      return false;
    }
    if (!countOne()) return false;
    value.setLine(position_.line);
    stack_.push_back({std::move(value), {}, {}});
    return true;
  }

  bool close() {
    Json value = std::move(stack_.back().value);
    stack_.pop_back();
    place(std::move(value));
    return true;
  }

  std::string pointer() const {
    std::string out;
    for (const Level& level : stack_) {
      const bool list = level.value.is(Json::Kind::list);
      if (!list && level.key.empty()) break;
      out += '/';
      out += list ? std::to_string(level.value.list().size()) : escapedPointerKey(level.key);
    }
    return out;
  }

  void issue(std::string message, std::string where, std::string hint) {
    constexpr std::size_t kEnough = 100;  // a person reads no more; a hostile file makes millions
    if (issues_.size() >= kEnough) return;
    Issue& added = issues_.emplace_back();
    added.where.line = position_.line;
    added.where.pointer = std::move(where);
    added.message = std::move(message);
    added.hint = std::move(hint);
  }

  const JsonLimits& limits_;
  const Position& position_;
  std::vector<Issue>& issues_;
  std::vector<Level> stack_;
  std::size_t count_ = 0;
  Json root_;
};

}  // namespace

Json parseJson(std::string_view text, const JsonLimits& limits, std::vector<Issue>& issues) {
  if (text.size() > limits.bytes) {
    issues.emplace_back().message = "found " + std::to_string(text.size()) +
                                    " bytes, expected at most " + std::to_string(limits.bytes);
    return {};
  }
  // U+FEFF, which some editors put first: nothing that counts.
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  Position position;
  Builder builder(limits, position, issues);
  const CountingIterator begin(text.data(), &position);
  const CountingIterator end(text.data() + text.size(), &position);
  nlohmann::json::sax_parse(begin, end, &builder);
  return builder.take();
}

std::string jsonText(std::string_view text) {
  // Invalid UTF-8 (possible in names that never came from a file) becomes U+FFFD.
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace fascia
