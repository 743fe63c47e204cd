#include "interrupt.h"

#include <csignal>
#include <cstdlib>

namespace fascia {
namespace {

volatile std::sig_atomic_t receivedSignal = 0;

void remember(int signal) {
  receivedSignal = signal;
}

}  // namespace

void watchInterrupts() {
  struct sigaction action = {};
  action.sa_handler = remember;
  action.sa_flags = SA_RESTART;  // writes in progress are finished, not torn
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A reader that went away (a closed pipe, a dead ffmpeg) is an error of that write, not our end.
  std::signal(SIGPIPE, SIG_IGN);
}

int interruptSignal() {
  return receivedSignal;
}

void dieOfInterrupt() {
  std::signal(receivedSignal, SIG_DFL);
  std::raise(receivedSignal);
  std::_Exit(128 + receivedSignal);
}

}  // namespace fascia
