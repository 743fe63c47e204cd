#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace fascia {

// A program that is fed through its standard input. No shell is involved. It ends with ours, by
// abandonUnfinished() or as its input ends.
class ChildProcess {
 public:
  // Empty if there is no such program in PATH. arguments: without the program's own name. `output`:
  // an open file, which the program finds as kOutputPath; -1: none.
  static std::optional<ChildProcess> start(const std::string& program,
                                           const std::vector<std::string>& arguments,
                                           int output = -1);
  static constexpr const char* kOutputPath = "/proc/self/fd/3";
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();  // ends the program if it still runs

  bool write(const void* data, std::size_t bytes);  // false: it no longer listens
  bool finish();                                    // closes its input and waits; false: it failed
  std::string complaints() const;                   // what it wrote to standard error

 private:
  ChildProcess(pid_t pid, int input, int errors) : pid_(pid), input_(input), errors_(errors) {}

  pid_t pid_ = -1;
  int input_ = -1, errors_ = -1;
};

// What a part of this program did in a process of its own.
struct ForkResult {
  std::string bytes;       // what it wrote
  bool succeeded = false;  // it came to its end
  bool tooLong = false;    // it ran on beyond its time, and was ended
};

// Runs `work` in a copy of this process, which ends with ours (with the thread that called this),
// without any of our handlers of signals. What it writes to the descriptor it is given comes back,
// up to `maxBytes`. Throws Error if there can be no such process.
ForkResult runForked(const std::function<bool(int)>& work, std::size_t maxBytes, double wall_s);

// The program's full path, looked up in PATH; empty if it is not there.
std::string findProgram(const std::string& program);

}  // namespace fascia
