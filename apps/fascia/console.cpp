#include "console.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/printable.h>

#include "interrupt.h"

namespace fascia {
namespace {

// Nobody can be told that this failed.
void complain(const std::string& line) {
  const std::string text = printable(line) + '\n';
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace

void Console::addFlags(CLI::App& command) {
  command.add_flag("--json", json_, "Answer with one JSON document on standard output");
  command.add_flag("-q,--quiet", quiet_, "Say nothing unless something is wrong");
}

void Console::addVerboseFlag(CLI::App& command) {
  command.add_flag("-v,--verbose", verbose_, "Tell more");
}

void Console::say(const std::string& line) const {
  if (!json_ && !quiet_) print(printable(line) + '\n');
}

void Console::detail(const std::string& text) const {
  if (verbose_) say(text);
}

void Console::hint(const std::string& line) const {
  if (!quiet_) complain(line);
}

void Console::warn(const std::vector<Issue>& warnings) const {
  for (const Issue& warning : warnings) {
    const auto same = [&](const Issue& known) { return known.text() == warning.text(); };
    if (std::ranges::any_of(warnings_, same)) continue;
    hint("warning: " + warning.text());
    warnings_.push_back(warning);
  }
}

void Console::answer(Json document) const {
  document.set("warnings", toJson(warnings_));
  answered_ = true;
  if (json_) print(printableJson(printJson(document)));
}

void Console::fail(const Error& error) const {
  for (const Issue& issue : error.issues()) complain("error: " + issue.text());
  if (!answered_) answer(Json::Object{{"ok", false}, {"issues", toJson(error.issues())}});
}

void Console::refuse(const std::string& usage) const {
  for (std::size_t start = 0; start < usage.size();) {
    const std::size_t end = std::min(usage.find('\n', start), usage.size());
    complain(usage.substr(start, end - start));
    start = end + 1;
  }
}

void Console::print(const std::string& text) const {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() && writeFault_ == 0)
    writeFault_ = errno;
}

bool Console::delivered() const {
  if (std::fflush(stdout) != 0 && writeFault_ == 0) writeFault_ = errno;
  if (writeFault_ == 0) return true;
  if (writeFault_ == EPIPE) dieOf(SIGPIPE);
  complain(std::string("error: standard output cannot be written: ") + std::strerror(writeFault_));
  return false;
}

bool Console::showsProgress() const {
  return !json_ && !quiet_;
}

Json toJson(const std::vector<Issue>& issues) {
  Json::List list;
  for (const Issue& issue : issues) {
    Json entry = Json::Object{};
    if (!issue.where.file.empty()) entry.set("file", issue.where.file);
    if (issue.where.line > 0) entry.set("line", issue.where.line);
    if (!issue.where.pointer.empty()) entry.set("pointer", issue.where.pointer);
    entry.set("message", issue.message);
    if (!issue.hint.empty()) entry.set("hint", issue.hint);
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace fascia
