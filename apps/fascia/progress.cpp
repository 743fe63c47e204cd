#include "progress.h"

#include <algorithm>
#include <cstdio>

#include <fmt/core.h>
#include <unistd.h>

#include <fascia/base/printable.h>

namespace fascia {
namespace {

constexpr int kBarWidth = 30;
constexpr std::chrono::milliseconds kRedraw{100};  // faster only flickers
constexpr std::chrono::seconds kNextLine{4};       // shorter: logs drown in lines
constexpr const char* kClearLine = "\r\x1b[K";
constexpr double kTold = 0.02;  // earlier the time left is a guess

}  // namespace

ProgressBar::ProgressBar(const Console& console, std::string what)
    : what_(std::move(what)),
      visible_(console.showsProgress()),
      terminal_(isatty(STDERR_FILENO) == 1),
      shown_(start_) {}

ProgressBar::~ProgressBar() {
  if (visible_ && terminal_ && shown_ != start_) std::fputs(kClearLine, stderr);
}

void ProgressBar::update(double fraction) {
  const Clock::time_point now = Clock::now();
  if (visible_ && now - shown_ >= (terminal_ ? Clock::duration(kRedraw) : kNextLine)) {
    shown_ = now;
    show(std::clamp(fraction, 0.0, 1.0), std::chrono::duration<double>(now - start_).count());
  }
}

void ProgressBar::show(double fraction, double spent_s) {
  const std::string text = printable(progressText(what_, fraction, spent_s));
  if (terminal_) {
    const int filled = static_cast<int>(fraction * kBarWidth);
    fmt::print(stderr, "{}[{:#>{}}{:.>{}}] {}", kClearLine, "", filled, "", kBarWidth - filled,
               text);
  } else {
    fmt::print(stderr, "{}\n", text);
  }
  std::fflush(stderr);
}

std::string progressText(const std::string& what, double fraction, double spent_s) {
  std::string text = fmt::format("{}: {:.0f} %, {:.0f} s", what, 100 * fraction, spent_s);
  if (fraction > kTold) text += fmt::format(", {:.0f} s left", spent_s * (1 / fraction - 1));
  return text;
}

}  // namespace fascia
