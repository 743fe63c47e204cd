#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace fascia {

// A program that is fed through its standard input. No shell is involved.
class ChildProcess {
 public:
  // Empty if there is no such program in PATH. arguments: without the program's own name.
  static std::optional<ChildProcess> start(const std::string& program,
                                           const std::vector<std::string>& arguments);
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

// The program's full path, looked up in PATH; empty if it is not there.
std::string findProgram(const std::string& program);

}  // namespace fascia
