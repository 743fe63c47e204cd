#include <fascia/io/file/file.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fascia/base/error.h>

namespace fascia {
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

WholeFile::WholeFile(std::string path) : path_(std::move(path)) {
  static std::atomic<unsigned> counter{0};
  struct stat info {};
  if (stat(path_.c_str(), &info) == 0 && S_ISDIR(info.st_mode)) {
    throw fileError(path_, "is a folder, expected a file name");
  }
  temporary_ = path_ + "." + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp";
  const int descriptor = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor >= 0) file_ = fdopen(descriptor, "wb");
  if (!file_) {
    throw fileError(path_, std::string("cannot be written: ") + std::strerror(errno));
  }
}

WholeFile::~WholeFile() {
  if (!file_) return;
  std::fclose(file_);
  unlink(temporary_.c_str());
}

void WholeFile::fail(const char* what) {
  throw fileError(path_, std::string(what) + ": " + std::strerror(errno));
}

void WholeFile::write(const void* data, std::size_t bytes) {
  if (bytes > 0 && std::fwrite(data, 1, bytes, file_) != bytes) fail("cannot be written");
}

void WholeFile::commit() {
  if (std::fflush(file_) != 0) fail("cannot be written");
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot be put in its place");
  std::fclose(file_);
  file_ = nullptr;
}

void writeFileWhole(const std::string& path, std::string_view bytes) {
  WholeFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace fascia
