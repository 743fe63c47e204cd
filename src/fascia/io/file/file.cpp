#include <fascia/io/file/file.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fascia/base/error.h>
#include <fascia/io/file/inputs.h>
#include <fascia/io/file/temporary_file.h>

namespace fascia {
namespace {

// A terminal, /dev/null, a pipe, or the file that standard output goes to: there is nothing to be
// replaced.
bool isWrittenAsItComes(const struct stat& place) {
  if (S_ISCHR(place.st_mode) || S_ISFIFO(place.st_mode)) return true;
  struct stat output {};
  return S_ISREG(place.st_mode) && fstat(STDOUT_FILENO, &output) == 0 &&
         output.st_dev == place.st_dev && output.st_ino == place.st_ino;
}

// Without waiting for somebody to read from a pipe.
int openToWrite(const std::string& path, const struct stat& place) {
  if (S_ISREG(place.st_mode)) return fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
  const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
  if (descriptor >= 0) fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
  return descriptor;
}

}  // namespace

std::string readFile(const std::string& path, std::size_t maxBytes) {
  // O_NONBLOCK: opening a named pipe would wait for a writer for ever.
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw fileError(path, std::string("cannot be read: ") + std::strerror(errno));
  const std::unique_ptr<const int, void (*)(const int*)> closer(&descriptor,
                                                                [](const int* d) { close(*d); });
  struct stat info {};
  if (fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode)) {
    throw fileError(
        path, S_ISDIR(info.st_mode) ? "is a folder, expected a file" : "is not a regular file");
  }
  noteInput(path, info);
  std::string bytes;
  bytes.reserve(std::min(static_cast<std::size_t>(info.st_size), maxBytes) + 1);
  char buffer[1 << 16];
  for (;;) {
    const ssize_t got = read(descriptor, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw fileError(path, std::string("cannot be read: ") + std::strerror(errno));
    if (got == 0) return bytes;
    bytes.append(buffer, static_cast<std::size_t>(got));
    if (bytes.size() > maxBytes) {
      throw fileError(path, "is larger than " + std::to_string(maxBytes) + " bytes");
    }
  }
}

std::string folderOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return {};
  return slash == 0 ? "/" : path.substr(0, slash);
}

std::string_view withoutByteOrderMark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

WholeFile::WholeFile(std::string path) : path_(std::move(path)) {
  struct stat place {};
  int descriptor = -1;
  if (stat(path_.c_str(), &place) == 0 && isWrittenAsItComes(place)) {
    descriptor = openToWrite(path_, place);
  } else {
    temporary_ = std::make_unique<TemporaryFile>(path_);
    descriptor = fcntl(temporary_->descriptor(), F_DUPFD_CLOEXEC, 0);
  }
  if (descriptor >= 0) file_ = fdopen(descriptor, "wb");
  if (!file_) fail("cannot be written");
}

WholeFile::~WholeFile() {
  if (file_) std::fclose(file_);
}

void WholeFile::fail(const char* what) {
  throw fileError(path_, std::string(what) + ": " + std::strerror(errno));
}

void WholeFile::write(const void* data, std::size_t bytes) {
  if (bytes > 0 && std::fwrite(data, 1, bytes, file_) != bytes) fail("cannot be written");
}

void WholeFile::commit() {
  const bool written = std::fflush(file_) == 0;
  if (!written) fail("cannot be written");
  std::fclose(std::exchange(file_, nullptr));
  if (temporary_) temporary_->put();
}

void writeFileWhole(const std::string& path, std::string_view bytes) {
  WholeFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace fascia
