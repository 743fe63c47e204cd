#include <fascia/io/rig_import/assimp/assimp_import.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <assimp/Importer.hpp>

#include <fascia/base/error.h>
#include <fascia/io/file/file.h>
#include <fascia/io/rig_import/assimp/assimp_scene.h>
#include <fascia/io/rig_model/finish_model.h>
#include <fascia/io/rig_model/rig_stream.h>

namespace fascia {
namespace {

// What a stranger's file may cost us.
constexpr std::size_t kMaxAssimpBytes = std::size_t{512} << 20;
constexpr std::size_t kMaxResultBytes = std::size_t{2} << 30;
constexpr rlim_t kMaxSeconds = 120;
constexpr rlim_t kMaxMemoryBytes = rlim_t{8} << 30;

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

// Opens nothing outside of the file's folder.
class FolderOnly : public Assimp::DefaultIOSystem {
 public:
  explicit FolderOnly(const std::string& path)
      : folder_(std::filesystem::weakly_canonical(path).parent_path().string() + "/") {}

  bool Exists(const char* file) const override {
    return isInside(file) && DefaultIOSystem::Exists(file);
  }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return isInside(file) && mode[0] == 'r' ? DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  bool isInside(const char* file) const {
    std::error_code fault;
    return std::filesystem::weakly_canonical(file, fault).string().starts_with(folder_) && !fault;
  }
  std::string folder_;
};

// The model and its notes, as bytes.
std::string convert(const std::string& path, double scale) {
  Assimp::Importer importer;
  importer.SetIOHandler(new FolderOnly(path));  // the importer's from here on
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

void limit(__rlimit_resource what, rlim_t most) {
  const rlimit value{most, most};
  setrlimit(what, &value);
}

// In the child: what comes back starts with '+' or, before a message, '-'.
[[noreturn]] void runChild(const std::string& path, double scale, int out) {
  limit(RLIMIT_CPU, kMaxSeconds);
  limit(RLIMIT_CORE, 0);
#ifndef __SANITIZE_ADDRESS__  // which reserves more than any limit
  limit(RLIMIT_AS, kMaxMemoryBytes);
#endif
  bool told = false;
  try {
    const std::string result = convert(path, scale);
    told = writeAll(out, "+") && writeAll(out, result);
  } catch (const Error& error) {
    const Issue& issue = error.issues().front();
    told = writeAll(out, "-" + issue.message + '\n' + issue.hint);
  } catch (const std::exception& fault) {
    told = writeAll(out, std::string("-cannot be read: ") + fault.what() + '\n');
  }
  _exit(told ? 0 : 1);
}

std::string readAll(int file) {
  std::string bytes;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t got = read(file, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0 || bytes.size() > kMaxResultBytes) return bytes;
    bytes.append(buffer, static_cast<std::size_t>(got));
  }
}

}  // namespace

bool isAssimpEnding(std::string_view ending) {
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

RiggedModel readWithAssimp(const std::string& path, const RigImportOptions& options) {
  readFile(path, kMaxAssimpBytes);  // tells what is missing, no file, or too large
  int ends[2];
  if (pipe(ends) != 0) throw Error(issueOf(path, std::string("no pipe: ") + std::strerror(errno)));
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    runChild(path, options.scale, ends[1]);
  }
  close(ends[1]);
  const std::string result = child < 0 ? std::string() : readAll(ends[0]);
  close(ends[0]);
  int status = -1;
  while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (result.starts_with('-')) {
    const std::size_t end = std::min(result.find('\n'), result.size());
    throw Error(
        issueOf(path, result.substr(1, end - 1), result.substr(std::min(end + 1, result.size()))));
  }
  if (status != 0 || !result.starts_with('+')) {
    throw Error(issueOf(path, "breaks the library that reads such files", "export it as .glb"));
  }
  RiggedModel model = modelOf(std::string_view(result).substr(1), path);
  finishModel(path, options.scale, model);
  return model;
}

}  // namespace fascia
