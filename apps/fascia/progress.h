#pragma once

#include <chrono>
#include <string>

#include "console.h"

namespace fascia {

// A bar with the time left, on a terminal only; gone when the work is done.
class ProgressBar {
 public:
  ProgressBar(const Console& console, std::string what);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // fraction in [0, 1]. False when the person asked to stop.
  bool update(double fraction);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool visible_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_{};
};

}  // namespace fascia
