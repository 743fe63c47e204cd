#pragma once

#include <string>
#include <vector>

#include <fascia/base/error.h>
#include <fascia/io/json/json.h>

namespace CLI {
class App;
}

namespace fascia {

// How a subcommand talks: text for a person, or one JSON document on stdout for a machine.
// Errors and hints go to stderr either way. Whatever would move a terminal's cursor is shown as an
// escape (see printable.h): names come from strangers' files.
class Console {
 public:
  void addFlags(CLI::App& command);        // --json, --quiet
  void addVerboseFlag(CLI::App& command);  // --verbose, where there is more to tell

  void say(const std::string& line) const;     // stdout; not with --json or --quiet
  void detail(const std::string& text) const;  // stdout; only with --verbose
  void hint(const std::string& line) const;    // stderr; not with --quiet
  // What a person should know though it does not stop anything: each a line on stderr, once, not
  // with --quiet; and all of them in the answer.
  void warn(const std::vector<Issue>& warnings) const;
  void answer(Json document) const;  // stdout; only with --json; with all warnings
  // Every issue a line on stderr; with --json the answer, unless one was given.
  void fail(const Error& error) const;

  void print(const std::string& text) const;  // stdout, as it is: of our own
  // Every line of a usage message, to stderr.
  void refuse(const std::string& usage) const;
  // Whether all that was said reached standard output. If not, tells, or ends the program as a
  // closed pipe does.
  bool delivered() const;

  bool isVerbose() const { return verbose_; }
  // Whether to tell how far the work is: someone wants text.
  bool showsProgress() const;

 private:
  mutable int writeFault_ = 0;  // errno of the first
  bool json_ = false;
  mutable bool answered_ = false;
  mutable std::vector<Issue> warnings_;
  bool quiet_ = false;
  bool verbose_ = false;
};

// [{"file", "line", "pointer", "message", "hint"}, …], empty parts left out.
Json toJson(const std::vector<Issue>& issues);

}  // namespace fascia
