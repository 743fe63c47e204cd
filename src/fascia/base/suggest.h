#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace fascia {

// A name from a file made fit for a message: quoted, control characters replaced, cut when long.
inline std::string quotedName(std::string_view name) {
  constexpr std::size_t kLongest = 60;
  std::string text = "'";
  for (const char c : name.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    text += byte < 0x20 || byte == 0x7f ? '?' : c;
  }
  return text + (name.size() > kLongest ? "…'" : "'");
}

// A number as a person would write it in a message.
inline std::string shortNumber(double number) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", number);
  return buffer;
}

// Finds the known name that a person most likely meant: offer every known name, then ask for the
// hint. Uses the optimal string alignment distance (insert, delete, replace, swap neighbours).
// Long names are not compared, so that a hostile file cannot make errors expensive.
class NearestName {
 public:
  explicit NearestName(std::string_view found) : found_(found), bestDistance_(allowance(found)) {}

  void offer(std::string_view known) {
    const int distance = boundedDistance(known);
    if (distance >= bestDistance_) return;
    bestDistance_ = distance;
    best_ = known;
  }

  const std::string& best() const { return best_; }  // empty: nothing is near
  std::string hint() const {
    return best_.empty() ? "" : "did you mean " + quotedName(best_) + "?";
  }

 private:
  static constexpr std::size_t kLongest = 48;

  // One slip per three letters, plus one because the best must be strictly nearer.
  static int allowance(std::string_view name) {
    return static_cast<int>(std::max<std::size_t>(1, name.size() / 3)) + 1;
  }

  int boundedDistance(std::string_view known) const {
    const std::size_t n = found_.size(), m = known.size();
    const std::size_t difference = n > m ? n - m : m - n;
    if (n > kLongest || m > kLongest || difference >= static_cast<std::size_t>(bestDistance_)) {
      return bestDistance_;
    }
    std::array<int, kLongest + 1> before{}, previous{}, row{};
    for (std::size_t j = 0; j <= m; ++j) previous[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= n; ++i) {
      row[0] = static_cast<int>(i);
      for (std::size_t j = 1; j <= m; ++j) {
        const int replace = previous[j - 1] + (found_[i - 1] == known[j - 1] ? 0 : 1);
        row[j] = std::min({previous[j] + 1, row[j - 1] + 1, replace});
        const bool swapped =
            i > 1 && j > 1 && found_[i - 1] == known[j - 2] && found_[i - 2] == known[j - 1];
        if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
      }
      before = previous;
      previous = row;
    }
    return previous[m];
  }

  std::string_view found_;
  std::string best_;
  int bestDistance_;
};

// The hint for a name that is none of `known`; empty if nothing is near.
template <class Names>
std::string didYouMean(std::string_view found, const Names& known) {
  NearestName nearest(found);
  for (const auto& name : known) nearest.offer(name);
  return nearest.hint();
}

}  // namespace fascia
