#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "console.h"

namespace fascia {

// What there is to tell: lines for a person, an object for a machine.
class Facts {
 public:
  void add(const std::string& name, int value) { add(name, value, fmt::format("{}", value)); }
  void add(const std::string& name, double value) { add(name, value, fmt::format("{:g}", value)); }
  void add(const std::string& name, const std::string& value) { add(name, value, value); }
  void add(const std::string& name, Json value, const std::string& text) {
    add(name, std::move(value), std::vector<std::string>{text});
  }
  void add(const std::string& name, Json value, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) lines_.push_back(fmt::format("{:13}  {}", name, text));
    answer_.set(name, std::move(value));
  }

  // Lines that stand for themselves, to be copied into a file.
  void addLines(const std::string& name, Json value, std::string lines) {
    while (!lines.empty()) {
      const std::size_t end = std::min(lines.find('\n'), lines.size());
      lines_.push_back(lines.substr(0, end));
      lines.erase(0, end + 1);
    }
    answer_.set(name, std::move(value));
  }

  void show(const Console& console) const {
    for (const std::string& line : lines_) console.say(line);
    console.answer(answer_);
  }

 private:
  std::vector<std::string> lines_;
  Json answer_ = Json::Object{{"ok", true}};
};

inline int count(std::size_t n) {
  return static_cast<int>(n);
}

}  // namespace fascia
