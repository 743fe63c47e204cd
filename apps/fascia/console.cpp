#include "console.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

namespace fascia {

void Console::addFlags(CLI::App& command) {
  command.add_flag("--json", json_, "Answer with one JSON document on standard output");
  command.add_flag("-q,--quiet", quiet_, "Say nothing unless something is wrong");
}

void Console::addVerboseFlag(CLI::App& command) {
  command.add_flag("-v,--verbose", verbose_, "Tell more");
}

void Console::say(const std::string& line) const {
  if (!json_ && !quiet_) fmt::print("{}\n", line);
}

void Console::detail(const std::string& text) const {
  if (verbose_) say(text);
}

void Console::hint(const std::string& line) const {
  if (!quiet_) fmt::print(stderr, "{}\n", line);
}

void Console::answer(const Json& document) const {
  if (json_) fmt::print("{}", printJson(document));
  answered_ = true;
}

void Console::fail(const Error& error) const {
  for (const Issue& issue : error.issues()) fmt::print(stderr, "error: {}\n", issue.text());
  if (!answered_) answer(Json::Object{{"ok", false}, {"issues", toJson(error.issues())}});
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
