#include "progress.h"

#include <algorithm>
#include <cstdio>

#include <fmt/core.h>

#include "interrupt.h"

namespace fascia {
namespace {

constexpr int kBarWidth = 30;
constexpr std::chrono::milliseconds kRedraw{100};  // faster only flickers
constexpr const char* kClearLine = "\r\x1b[K";

}  // namespace

ProgressBar::ProgressBar(const Console& console, std::string what)
    : what_(std::move(what)), visible_(console.showsProgress()) {}

ProgressBar::~ProgressBar() {
  if (visible_) std::fputs(kClearLine, stderr);
}

bool ProgressBar::update(double fraction) {
  const Clock::time_point now = Clock::now();
  if (visible_ && now - drawn_ >= kRedraw) {
    drawn_ = now;
    fraction = std::clamp(fraction, 0.0, 1.0);
    const double spent_s = std::chrono::duration<double>(now - start_).count();
    const int filled = static_cast<int>(fraction * kBarWidth);
    std::string left;
    if (fraction > 0.02) left = fmt::format(", {:.0f} s left", spent_s * (1 / fraction - 1));
    fmt::print(stderr, "{}{} [{:#>{}}{:.>{}}] {:3.0f} %{}", kClearLine, what_, "", filled, "",
               kBarWidth - filled, 100 * fraction, left);
    std::fflush(stderr);
  }
  return interruptSignal() == 0;
}

}  // namespace fascia
