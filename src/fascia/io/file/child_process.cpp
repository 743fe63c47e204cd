#include <fascia/io/file/child_process.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fascia/base/error.h>
#include <fascia/io/file/inputs.h>
#include <fascia/io/file/unfinished.h>

extern char** environ;

namespace fascia {
namespace {

void closeIfOpen(int& descriptor) {
  if (descriptor >= 0) close(descriptor);
  descriptor = -1;
}

// Signals that we ignore or block reach other programs as usual; but too large a file stays an
// error that they can tell of.
void setSignals(posix_spawnattr_t& attributes) {
  sigset_t none, usual;
  sigemptyset(&none);
  sigemptyset(&usual);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) sigaddset(&usual, signal);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
}

pid_t spawn(const std::string& path, const std::vector<std::string>& arguments, int input,
            int output, int errors) {
  std::vector<char*> argv{const_cast<char*>(path.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
  if (output >= 0) posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO + 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  setSignals(attributes);
  pid_t pid = -1;
  const auto lock = lockUnfinished();
  const int failed = posix_spawn(&pid, path.c_str(), &actions, &attributes, argv.data(), environ);
  if (failed == 0) listChild(pid);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return failed ? -1 : pid;
}

// Waits for a child; its number may be another's from then on.
int reap(pid_t pid) {
  // Not collected yet while it is on the list: nobody else can have its number.
  siginfo_t ended{};
  while (waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  const auto lock = lockUnfinished();
  unlistChild(pid);
  int status = -1;
  waitpid(pid, &status, 0);
  return status;
}

[[noreturn]] void workAsChild(const std::function<bool(int)>& work, int out, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it ended before it could tell
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  _exit(work(out) ? 0 : 1);
}

pid_t forkListed(const std::function<bool(int)>& work, int out) {
  const pid_t parent = getpid();
  const auto lock = lockUnfinished();
  lockInputs();
  const pid_t child = fork();
  unlockInputs();
  if (child == 0) workAsChild(work, out, parent);
  if (child > 0) listChild(child);
  return child;
}

// False: the time was over first.
bool readUntil(int file, std::chrono::steady_clock::time_point deadline, std::size_t maxBytes,
               std::string& bytes) {
  char buffer[1 << 16];
  for (;;) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd ready{file, POLLIN, 0};
    if (poll(&ready, 1, static_cast<int>(std::min<long long>(left.count(), 60'000))) <= 0) continue;
    const ssize_t got = read(file, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0 || bytes.size() > maxBytes) return true;
    bytes.append(buffer, static_cast<std::size_t>(got));
  }
}

}  // namespace

std::string findProgram(const std::string& program) {
  if (program.find('/') != std::string::npos) {
    return access(program.c_str(), X_OK) == 0 ? program : std::string();
  }
  const char* variable = std::getenv("PATH");
  std::string_view folders = variable ? variable : "";
  while (!folders.empty()) {
    const std::size_t end = std::min(folders.find(':'), folders.size());
    const std::string path = std::string(folders.substr(0, end)) + '/' + program;
    if (access(path.c_str(), X_OK) == 0) return path;
    folders.remove_prefix(std::min(end + 1, folders.size()));
  }
  return {};
}

std::optional<ChildProcess> ChildProcess::start(const std::string& program,
                                                const std::vector<std::string>& arguments,
                                                int output) {
  const std::string path = findProgram(program);
  // A socket, not a pipe: writing to a program that has ended must not raise SIGPIPE in ours.
  int ends[2];
  if (path.empty() || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return {};
  int errors = memfd_create("errors", MFD_CLOEXEC);
  const pid_t pid = spawn(path, arguments, ends[1], output, errors);
  close(ends[1]);
  if (pid >= 0) return ChildProcess(pid, ends[0], errors);
  close(ends[0]);
  closeIfOpen(errors);
  return {};
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      input_(std::exchange(other.input_, -1)),
      errors_(std::exchange(other.errors_, -1)) {}

ChildProcess::~ChildProcess() {
  closeIfOpen(input_);
  closeIfOpen(errors_);
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  reap(pid_);
}

bool ChildProcess::write(const void* data, std::size_t bytes) {
  const char* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t sent = send(input_, at, bytes, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent;
    bytes -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool ChildProcess::finish() {
  closeIfOpen(input_);
  const int status = reap(std::exchange(pid_, -1));
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

ForkResult runForked(const std::function<bool(int)>& work, std::size_t maxBytes, double wall_s) {
  const auto deadline = std::chrono::steady_clock::now() +
                        std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                            std::chrono::duration<double>(wall_s));
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error(std::string("no pipe: ") + std::strerror(errno));
  const pid_t child = forkListed(work, ends[1]);
  close(ends[1]);
  ForkResult result;
  if (child > 0) {
    result.tooLong = !readUntil(ends[0], deadline, maxBytes, result.bytes);
    kill(child, SIGKILL);  // has told all, or will not
  }
  close(ends[0]);
  if (child < 0) throw Error("no other process can be started");
  const int status = reap(child);
  result.succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) result.tooLong = true;
  return result;
}

std::string ChildProcess::complaints() const {
  std::string text(4000, '\0');
  const ssize_t got = pread(errors_, text.data(), text.size(), 0);
  text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  while (text.ends_with('\n')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ';');  // one line of a message
  return text;
}

}  // namespace fascia
