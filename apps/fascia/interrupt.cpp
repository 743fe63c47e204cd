#include "interrupt.h"

#include <csignal>
#include <cstdlib>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

#include <fascia/io/file/unfinished.h>

namespace fascia {

void watchInterrupts() {
  sigset_t watched;
  sigemptyset(&watched);
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, SIG_DFL);
    sigaddset(&watched, signal);
  }
  // Blocked in all threads, they wait for the one that asks for them: no work has to look out for
  // them, and what ends it need not be fit for a handler of signals.
  pthread_sigmask(SIG_BLOCK, &watched, nullptr);
  std::thread([watched] {
    int signal = 0;
    if (sigwait(&watched, &signal) != 0) return;
    abandonUnfinished();
    if (isatty(STDERR_FILENO) == 1) {
      constexpr char kClearLine[] = "\r\x1b[K";  // of a progress bar
      [[maybe_unused]] const ssize_t done = write(STDERR_FILENO, kClearLine, sizeof kClearLine - 1);
    }
    dieOf(signal);
  }).detach();
}

void keepWriteErrors() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void holdStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    // The wrong way round: reading and writing fail as they would have.
    if (fcntl(stream, F_GETFD) < 0)
      open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // the lowest that is free
}

void dieOf(int signal) {
  std::signal(signal, SIG_DFL);
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, signal);
  pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
  std::raise(signal);
  std::_Exit(128 + signal);
}

}  // namespace fascia
