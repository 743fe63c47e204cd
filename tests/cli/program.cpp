#include "program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

namespace fs = std::filesystem;

std::string readWhole(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

nlohmann::json Outcome::json() const {
  nlohmann::json parsed = nlohmann::json::parse(out, nullptr, false);
  EXPECT_FALSE(parsed.is_discarded()) << "no JSON: " << out << err;
  return parsed;
}

Process::Process(const fs::path& folder, const std::vector<std::string>& arguments) {
  static int count = 0;
  const std::string stem = folder.string() + "." + std::to_string(++count);
  out_ = stem + ".out";
  err_ = stem + ".err";
  std::vector<char*> argv = {const_cast<char*>(FASCIA_PROGRAM)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_.c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_.c_str(), flags, 0600);
  const int failed = posix_spawn(&pid_, FASCIA_PROGRAM, &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(failed, 0) << "cannot start " << FASCIA_PROGRAM;
  ended_ = failed != 0;
}

Process::~Process() {
  if (!ended_) {
    send(SIGKILL);
    wait();
  }
  fs::remove(out_);
  fs::remove(err_);
}

void Process::note(int status) {
  ended_ = true;
  if (WIFEXITED(status)) outcome_.exitCode = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome_.signal = WTERMSIG(status);
  outcome_.out = readWhole(out_);
  outcome_.err = readWhole(err_);
}

bool Process::running() {
  int status = 0;
  if (!ended_ && waitpid(pid_, &status, WNOHANG) == pid_) note(status);
  return !ended_;
}

void Process::send(int signal) const {
  if (!ended_) kill(pid_, signal);
}

bool Process::hasChild() const {
  const std::string id = std::to_string(pid_);
  return !ended_ && !readWhole("/proc/" + id + "/task/" + id + "/children").empty();
}

Outcome Process::wait() {
  int status = 0;
  if (!ended_ && waitpid(pid_, &status, 0) == pid_) note(status);
  return outcome_;
}

Cli::Cli() {
  std::string name = (fs::path(testing::TempDir()) / "fascia_cli_XXXXXX").string();
  folder_ = mkdtemp(name.data());
  fs::copy_file(fs::path(FASCIA_CLI_TESTS) / "ball.fascia.json", folder_ / "ball.fascia.json");
}

Cli::~Cli() {
  fs::remove_all(folder_);
}

Outcome Cli::run(const std::vector<std::string>& arguments) const {
  return Process(folder_, arguments).wait();
}

std::string Cli::content(const std::string& file) const {
  return readWhole(folder_ / file);
}

void Cli::write(const std::string& file, const std::string& text) const {
  std::ofstream(folder_ / file, std::ios::binary) << text;
}

std::vector<std::string> Cli::files() const {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}
