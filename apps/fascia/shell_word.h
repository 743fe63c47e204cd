#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace fascia {

// A text as one word of a command that is shown, to be pasted into a shell.
inline std::string shellWord(const std::string& text) {
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) || c >= 0x80 ||
           std::string("_./+:=@%,-").find(char(c)) != std::string::npos;
  });
  if (plain) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace fascia
