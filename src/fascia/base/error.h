#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace fascia {

// Where in a person's input something was found. Empty parts are left out of the message.
struct Location {
  std::string file;
  int line = 0;         // 1-based; 0 = unknown
  std::string pointer;  // JSON pointer, e.g. "/skin/material/density_kg_per_m2"
};

// The JSON pointer to an entry of the list at `list`.
inline std::string entryOf(const std::string& list, std::size_t index) {
  return list + "/" + std::to_string(index);
}

// One thing that is wrong with the input: what was found, what was expected, how to mend it.
struct Issue {
  Location where;
  std::string message;  // "found -3, expected a number in (0, 1e6]"
  std::string hint;     // how to mend it; may be empty

  // "penguin.fascia.json:12: /skin/grid: found [0, 8], expected … (hint)"
  std::string text() const;
};

// Bad input, thrown at the edges only (reading, building). Stage functions never throw.
class Error : public std::runtime_error {
 public:
  explicit Error(Issue issue);
  explicit Error(std::vector<Issue> issues);  // at least one
  explicit Error(const std::string& message);

  const std::vector<Issue>& issues() const { return issues_; }

 private:
  std::vector<Issue> issues_;
};

// Of a file as a whole: "penguin.glb: is cut short".
Error fileError(const std::string& path, std::string message, std::string hint = {});

// Collects all issues of one input, so that a person sees every error at once, not the first only.
class Diagnostics {
 public:
  // pointer is a JSON pointer into the definition being built
  void error(std::string pointer, std::string message, std::string hint = {});
  void warning(std::string pointer, std::string message, std::string hint = {});

  bool ok() const { return errors_.empty(); }
  const std::vector<Issue>& errors() const { return errors_; }
  const std::vector<Issue>& warnings() const { return warnings_; }
  void throwIfErrors() const;  // throws Error with every error collected

 private:
  std::vector<Issue> errors_, warnings_;
};

}  // namespace fascia
