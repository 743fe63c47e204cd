#pragma once

#include <chrono>
#include <string>

#include "console.h"

namespace fascia {

// How far a step is and when it will be done: on a terminal a bar, gone when the work is done,
// elsewhere a line now and then. Short steps show nothing.
class ProgressBar {
 public:
  ProgressBar(const Console& console, std::string what);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // fraction in [0, 1]
  void update(double fraction);

 private:
  using Clock = std::chrono::steady_clock;
  void show(double fraction, double spent_s);

  std::string what_;
  bool visible_, terminal_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point shown_;
};

// "drawing: 42 %, 12 s, 17 s left"; without the time left where it cannot be told yet.
std::string progressText(const std::string& what, double fraction, double spent_s);

}  // namespace fascia
