#include <fascia/io/rig_import/assimp/assimp_import.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <new>

#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/resource.h>
#include <unistd.h>
#include <assimp/Importer.hpp>

#include <fascia/base/error.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/file/file.h>
#include <fascia/io/file/inputs.h>
#include <fascia/io/file/inside_folder.h>
#include <fascia/io/rig_import/assimp/assimp_scene.h>
#include <fascia/io/rig_model/finish_model.h>
#include <fascia/io/rig_model/rig_stream.h>

namespace fascia {
namespace {

// What a stranger's file may cost us.
constexpr std::size_t kMaxAssimpBytes = std::size_t{512} << 20;
constexpr std::size_t kMaxResultBytes = std::size_t{2} << 30;
// Time and memory: enough for a small file, and more for what its size asks for, up to a limit.
constexpr double kLeastSeconds = 10, kMostSeconds = 120, kSecondsPerMegabyte = 1;
constexpr double kWallShare = 3;  // of the time it may compute: other programs run as well
constexpr std::size_t kLeastMemoryBytes = std::size_t{1} << 30;
constexpr std::size_t kMostMemoryBytes = std::size_t{8} << 30;
constexpr std::size_t kMemoryPerByte = 64;

// Formats that can hold a rig; the others could only lead to "needs a rig".
constexpr std::array<std::string_view, 12> kEndings = {".fbx",     ".dae",  ".x",   ".blend",
                                                       ".md5mesh", ".ms3d", ".b3d", ".smd",
                                                       ".mdl",     ".obj",  ".ply", ".stl"};

Issue issueOf(const std::string& path, std::string message, std::string hint = {}) {
  Issue issue;
  issue.where.file = path;
  issue.message = std::move(message);
  issue.hint = std::move(hint);
  return issue;
}

// A regular file, whole in memory.
class WholeStream : public Assimp::MemoryIOStream {
 public:
  explicit WholeStream(const std::string& bytes)
      : MemoryIOStream(copyOf(bytes), bytes.size(), true) {}

 private:
  static const std::uint8_t* copyOf(const std::string& bytes) {
    auto* copy = new std::uint8_t[bytes.size()];  // the stream's from here on
    std::copy(bytes.begin(), bytes.end(), copy);
    return copy;
  }
};

// Opens the file, and regular files beside it or below: none that is named by an absolute path or
// one that climbs, no link that leads elsewhere, no pipe and no device.
class NeighboursOnly : public Assimp::IOSystem {
 public:
  explicit NeighboursOnly(const std::string& path)
      : path_(path), folder_(folderOf(path)), left_bytes_(kMaxAssimpBytes) {}

  bool Exists(const char* file) const override {
    std::error_code fault;
    const std::string place = placeOf(file);
    return !place.empty() && std::filesystem::is_regular_file(place, fault);
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    const std::string place = placeOf(file);
    if (place.empty() || mode[0] != 'r') return nullptr;
    try {
      const std::string bytes = readFile(place, left_bytes_);
      left_bytes_ -= bytes.size();
      return new WholeStream(bytes);
    } catch (const Error&) {
      return nullptr;
    }
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  // Empty: it may not be opened. Names come with the file's folder before them, or without.
  std::string placeOf(std::string_view file) const {
    if (file == path_) return path_;
    const std::string before = folder_ == "/" ? folder_ : folder_ + "/";
    if (!folder_.empty() && file.starts_with(before)) file.remove_prefix(before.size());
    std::string name(file);
    std::replace(name.begin(), name.end(), '\\', '/');
    while (name.starts_with("./")) name.erase(0, 2);
    try {
      return insideFolder(folder_, name, "", "");
    } catch (const Error&) {
      return {};
    }
  }

  std::string path_, folder_;
  std::size_t left_bytes_;
};

// The model and its notes, as bytes.
std::string convert(const std::string& path, double scale) {
  Assimp::Importer importer;
  importer.SetIOHandler(new NeighboursOnly(path));  // the importer's from here on
  // Nodes that hold pieces of one joint's transformation are joined to that joint.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(
      path, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_GenSmoothNormals |
                aiProcess_JoinIdenticalVertices | aiProcess_FindInvalidData);
  if (!scene || !scene->mRootNode) {
    throw Error(issueOf(path, std::string("cannot be read: ") + importer.GetErrorString()));
  }
  const RiggedModel model = rigFromAssimp(*scene, path, scale);
  ByteWriter out;
  writeRig(model, model.motions, out);
  out.value(static_cast<std::uint64_t>(model.notes.size()));
  for (const std::string& note : model.notes) out.text(note);
  return std::move(out.bytes);
}

RiggedModel modelOf(std::string_view bytes, const std::string& path) {
  ByteReader in(bytes, path);
  RiggedModel model = readRig(in);
  const auto notes = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < notes; ++i) model.notes.push_back(in.text());
  return model;
}

bool writeAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = write(file, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return true;
}

void limit(__rlimit_resource what, rlim_t most, rlim_t beyond = 0) {
  const rlimit value{most, most + beyond};
  setrlimit(what, &value);
}

// What this process has reserved so far: its copy starts with that.
std::size_t reservedBytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

struct AssimpBudget {
  double seconds;
  std::size_t memory_bytes;
};

AssimpBudget budgetFor(std::size_t fileBytes) {
  const double megabytes = static_cast<double>(fileBytes) / (1 << 20);
  return {std::min(kLeastSeconds + kSecondsPerMegabyte * megabytes, kMostSeconds),
          std::min(kLeastMemoryBytes + kMemoryPerByte * fileBytes, kMostMemoryBytes)};
}

void limitSelf(const AssimpBudget& budget) {
  limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(budget.seconds)), 1);  // SIGXCPU comes first
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
#ifndef __SANITIZE_ADDRESS__  // which reserves more than any limit
  limit(RLIMIT_AS, reservedBytes() + budget.memory_bytes);
#endif
}

// The files that were read, for the memory of the process that writes (see inputs.h).
std::string notedFiles() {
  ByteWriter out;
  const std::vector<FileId> inputs = notedInputs();
  out.value(static_cast<std::uint64_t>(inputs.size()));
  for (const FileId& id : inputs) out.value(id);
  return std::move(out.bytes);
}

// In the copy: what comes back starts with '+' or, before a message, '-'.
bool tellModel(const std::string& path, double scale, int out) {
  try {
    const std::string result = convert(path, scale);
    return writeAll(out, "+") && writeAll(out, notedFiles()) && writeAll(out, result);
  } catch (const Error& error) {
    const Issue& issue = error.issues().front();
    return writeAll(out, "-" + issue.message + '\n' + issue.hint);
  } catch (const std::bad_alloc&) {
    return writeAll(out, "-needs more memory than its size asks for\nexport it as .glb");
  } catch (const std::exception& fault) {
    return writeAll(out, std::string("-cannot be read: ") + fault.what() + '\n');
  }
}

RiggedModel modelFrom(std::string_view told, const std::string& path) {
  ByteReader in(told, path);
  const auto files = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < files; ++i) noteInput(in.value<FileId>());
  return modelOf(in.take(in.left()), path);
}

}  // namespace

bool isAssimpEnding(std::string_view ending) {
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

RiggedModel readWithAssimp(const std::string& path, const RigImportOptions& options) {
  // Tells what is missing, no file, or too large.
  const AssimpBudget budget = budgetFor(readFile(path, kMaxAssimpBytes).size());
  const auto work = [&](int out) {
    limitSelf(budget);
    return tellModel(path, options.scale, out);
  };
  const ForkResult result = runForked(work, kMaxResultBytes, kWallShare * budget.seconds);
  const std::string_view told = result.bytes;
  if (told.starts_with('-')) {
    const std::size_t end = std::min(told.find('\n'), told.size());
    throw Error(issueOf(path, std::string(told.substr(1, end - 1)),
                        std::string(told.substr(std::min(end + 1, told.size())))));
  }
  const std::string mend = "export it as .glb";
  if (result.tooLong)
    throw Error(issueOf(path,
                        "takes the library that reads such files more time than its size "
                        "asks for",
                        mend));
  if (!result.succeeded || !told.starts_with('+'))
    throw Error(issueOf(path, "breaks the library that reads such files", mend));
  RiggedModel model = modelFrom(told.substr(1), path);
  finishModel(path, options.scale, model);
  return model;
}

}  // namespace fascia
