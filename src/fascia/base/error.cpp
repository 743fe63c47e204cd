#include <fascia/base/error.h>

#include <utility>

namespace fascia {
namespace {

std::string joined(const std::vector<Issue>& issues) {
  std::string text;
  for (const Issue& issue : issues) {
    if (!text.empty()) text += '\n';
    text += issue.text();
  }
  return text;
}

}  // namespace

std::string Issue::text() const {
  std::string out = where.file;
  if (where.line > 0) out += (out.empty() ? "line " : ":") + std::to_string(where.line);
  if (!where.pointer.empty()) out += (out.empty() ? "" : ": ") + where.pointer;
  if (!out.empty()) out += ": ";
  out += message;
  if (!hint.empty()) out += " (" + hint + ")";
  return out;
}

Error::Error(Issue issue) : Error(std::vector<Issue>{std::move(issue)}) {}

Error::Error(std::vector<Issue> issues)
    : std::runtime_error(joined(issues)), issues_(std::move(issues)) {}

Error::Error(const std::string& message) : Error(Issue{{}, message, {}}) {}

Error fileError(const std::string& path, std::string message, std::string hint) {
  return Error(Issue{{path, 0, {}}, std::move(message), std::move(hint)});
}

void Diagnostics::error(std::string pointer, std::string message, std::string hint) {
  errors_.push_back({{{}, 0, std::move(pointer)}, std::move(message), std::move(hint)});
}

void Diagnostics::warning(std::string pointer, std::string message, std::string hint) {
  warnings_.push_back({{{}, 0, std::move(pointer)}, std::move(message), std::move(hint)});
}

void Diagnostics::throwIfErrors() const {
  if (!errors_.empty()) throw Error(errors_);
}

}  // namespace fascia
