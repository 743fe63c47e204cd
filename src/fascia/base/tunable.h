#pragma once

// What a person can set, in tables: a row for each number, switch or word, beside the structure
// that holds it. Readers, builders, the JSON Schema and the documentation are made from the rows,
// so that they cannot disagree. To add a setting, add the member and its row.
//
//   struct FatDef { double thickness_m = 0.01; };
//   constexpr auto tunables(const FatDef*) {
//     return std::tuple{tunable(&FatDef::thickness_m, "thickness_m", "m", {0, 1}, "How thick")};
//   }

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include <fascia/base/error.h>

namespace fascia {

// Shortest digits that read back to the same bits, as a person would write them: "1e6".
std::string shortestText(double value);
std::string shortestText(float value);

struct NumberRange {
  double min = -1e9, max = 1e9;
  bool aboveMin = false;  // min itself is refused

  constexpr bool contains(double x) const { return (aboveMin ? x > min : x >= min) && x <= max; }
  // Of a number that was rounded to float: so are the ends.
  constexpr bool contains(float x) const {
    const auto low = static_cast<float>(min), high = static_cast<float>(max);
    return (aboveMin ? x > low : x >= low) && x <= high;
  }
  std::string text() const;       // "a number in (0, 1e6]"
  std::string wholeText() const;  // "a whole number in [2, 3]"
};

inline constexpr NumberRange positive(double max) {
  return {0, max, true};
}

// What a row says whatever the member is.
struct TunableInfo {
  std::string_view key;   // as in files; "_deg" in it: degrees there, radians in memory
  std::string_view unit;  // "N/m"; empty: a pure number, a switch or a word
  NumberRange range;      // in the file's unit; of each entry of a vector
  std::string_view help;  // a line for people
  bool isRequired = false;

  constexpr bool isAngle() const { return key.find("_deg") != key.npos; }
};

// A row: a number, a vector, an optional one of these or a switch (bool).
template <class T, class M>
struct Tunable : TunableInfo {
  M T::*member;

  constexpr Tunable required() const {
    Tunable out = *this;
    out.isRequired = true;
    return out;
  }
};

template <class T, class M>
constexpr Tunable<T, M> tunable(M T::*member, std::string_view key, std::string_view unit,
                                NumberRange range, std::string_view help) {
  return {{key, unit, range, help}, member};
}
template <class T>
constexpr Tunable<T, bool> tunable(bool T::*member, std::string_view key, std::string_view help) {
  return {{key, {}, {0, 1}, help}, member};
}

// A row: one of a few words.
template <class T>
struct WordTunable : TunableInfo {
  std::string T::*member;
  std::vector<std::string_view> (*words)();
};

template <class T>
constexpr WordTunable<T> wordTunable(std::string T::*member, std::string_view key,
                                     std::vector<std::string_view> (*words)(),
                                     std::string_view help) {
  return {{key, {}, {}, help}, member, words};
}

// f(row) for each row of T's table.
template <class T, class F>
void forEachTunable(const F& f) {
  std::apply([&](const auto&... row) { (f(row), ...); }, tunables(static_cast<const T*>(nullptr)));
}

// The row of a member. A program with a member that has none does not compile.
template <class T, class M>
constexpr TunableInfo tunableOf(M T::*member) {
  TunableInfo found;
  const auto look = [&](const auto& row) {
    if constexpr (std::is_same_v<decltype(row.member), M T::*>)
      if (row.member == member) found = row;
  };
  std::apply([&](const auto&... row) { (look(row), ...); },
             tunables(static_cast<const T*>(nullptr)));
  return found;
}

// "found 3, expected one of a, b", or empty if it is one of them. `hint`: the word that was meant.
std::string wordFault(std::string_view found, const std::vector<std::string_view>& words,
                      std::string& hint);

// Report what is out of its range: "found -3, expected a number in (0, 1e6]".
void checkNumber(const TunableInfo& row, double value, const std::string& pointer,
                 Diagnostics& diagnostics);
void checkWhole(const TunableInfo& row, int value, const std::string& pointer,
                Diagnostics& diagnostics);

namespace tunable_detail {

template <class M>
void check(const TunableInfo& row, const M& value, const std::string& pointer,
           Diagnostics& diagnostics) {
  if constexpr (std::is_same_v<M, double>) {
    checkNumber(row, value, pointer, diagnostics);
  } else if constexpr (std::is_same_v<M, int>) {
    checkWhole(row, value, pointer, diagnostics);
  } else if constexpr (requires { value.has_value(); }) {
    if (value) check(row, *value, pointer, diagnostics);
  } else if constexpr (!std::is_same_v<M, bool>) {
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(value.size()); ++i)
      check(row, value[i], entryOf(pointer, static_cast<std::size_t>(i)), diagnostics);
  }
}

}  // namespace tunable_detail

// Everything of T's table. `pointer` leads to the object: "/skin/material".
template <class T>
void validateTunables(const T& def, const std::string& pointer, Diagnostics& diagnostics) {
  forEachTunable<T>([&](const auto& row) {
    const auto& value = def.*row.member;
    const std::string at = pointer + '/' + std::string(row.key);
    if constexpr (requires { row.words; }) {
      std::string hint;
      const std::string fault = wordFault(value, row.words(), hint);
      if (!fault.empty()) diagnostics.error(at, fault, hint);
    } else {
      tunable_detail::check(row, value, at, diagnostics);
    }
  });
}

}  // namespace fascia
