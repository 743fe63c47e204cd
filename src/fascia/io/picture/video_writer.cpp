#include <fascia/io/picture/video_writer.h>

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <fascia/base/error.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/file/file.h>
#include <fascia/io/file/temporary_file.h>
#include <fascia/io/file/unfinished.h>

namespace fascia {
namespace fs = std::filesystem;

namespace {

std::string decimal(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

bool isGif(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".gif";
}

}  // namespace

class VideoWriter::Sink {
 public:
  virtual ~Sink() = default;
  virtual void add(const Image& frame) = 0;
  virtual void finish() = 0;
  virtual bool encodes() const = 0;
  std::string hint;
};

class VideoWriter::Encoder final : public Sink {
 public:
  Encoder(ChildProcess process, std::unique_ptr<TemporaryFile> file, std::string path)
      : file_(std::move(file)), process_(std::move(process)), path_(std::move(path)) {}

  static std::vector<std::string> arguments(int width, int height, const VideoOptions& options,
                                            bool gif) {
    std::vector<std::string> all{"-nostdin", "-loglevel", "error", "-y",
                                 // in
                                 "-f", "rawvideo", "-pixel_format", "rgba", "-video_size",
                                 std::to_string(width) + "x" + std::to_string(height), "-framerate",
                                 decimal(options.frame_rate_hz), "-i", "pipe:0"};
    const std::vector<std::string> out = gif ? gifArguments() : mp4Arguments(options.crf);
    all.insert(all.end(), out.begin(), out.end());
    all.push_back(std::string("file:") + ChildProcess::kOutputPath);
    return all;
  }

  // H.264 with 4:2:0 colour needs even sizes.
  static std::vector<std::string> mp4Arguments(int crf) {
    return {"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264",
            // A third of the default's time for files of the same size.
            "-preset", "veryfast", "-pix_fmt", "yuv420p", "-crf", std::to_string(crf), "-movflags",
            "+faststart", "-f", "mp4"};
  }
  // One palette for the whole film, made of all of its colours. Ordered dithering keeps still what
  // stands still, and so the file small.
  static std::vector<std::string> gifArguments() {
    const std::string palette = "split[seen][kept];[seen]palettegen=stats_mode=full[palette];";
    const std::string colours = "[kept][palette]paletteuse=dither=bayer:bayer_scale=4";
    return {"-filter_complex", palette + colours, "-loop", "0", "-f", "gif"};
  }

  void add(const Image& frame) override {
    if (process_.write(frame.rgba.data(), frame.rgba.size())) return;
    process_.finish();
    throw fileError(path_, "the video cannot be encoded: " + process_.complaints());
  }
  void finish() override {
    if (!process_.finish()) {
      throw fileError(path_, "the video cannot be encoded: " + process_.complaints());
    }
    file_->put();
  }
  bool encodes() const override { return true; }

 private:
  std::unique_ptr<TemporaryFile> file_;
  ChildProcess process_;  // ended before its file goes
  std::string path_;
};

// clip.mp4 -> clip/00000.png …; built under another name and renamed like a file.
class VideoWriter::PngSequence final : public Sink {
 public:
  PngSequence(const std::string& path, const VideoOptions& options) {
    const fs::path file(path);
    folder_ = (file.parent_path() / file.stem()).string();
    if (!file.has_extension()) folder_ += "-frames";
    std::error_code error;
    if (fs::exists(fs::symlink_status(folder_, error)))
      throw fileError(folder_, "is in the way of the picture sequence");
    makeTemporary();
    hint = "the program " + options.encoder + " was not found, so the frames are PNG files in " +
           folder_ + "; to join them: ffmpeg -framerate " + decimal(options.frame_rate_hz) +
           " -i " + folder_ + "/%05d.png " + (isGif(path) ? "" : "-pix_fmt yuv420p ") + path;
  }
  ~PngSequence() override {
    if (temporary_.empty()) return;
    const auto lock = lockUnfinished();
    removeOwnFolder(temporary_);
    unlistTemporary(temporary_);
  }

  void add(const Image& frame) override {
    char name[24];
    std::snprintf(name, sizeof name, "/%05d.png", count_++);
    try {
      writePng(frame, temporary_ + name);
    } catch (const Error& error) {  // by the name that it would have had
      throw fileError(folder_ + name, error.issues().front().message);
    }
  }
  // Never over anything: even an empty folder is somebody's.
  void finish() override {
    const auto lock = lockUnfinished();
    if (renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, folder_.c_str(), RENAME_NOREPLACE) != 0)
      throw fileError(folder_, std::string("cannot be put in its place: ") + std::strerror(errno));
    unlistTemporary(temporary_);
    temporary_.clear();
  }
  bool encodes() const override { return false; }

 private:
  void makeTemporary() {
    const std::string parent = folderOf(folder_);
    sweepTemporaries(parent);
    const auto lock = lockUnfinished();
    const std::string name = temporaryName(parent);
    if (mkdir(name.c_str(), 0777) != 0)
      throw fileError(folder_, std::string("cannot be made: ") + std::strerror(errno));
    temporary_ = name;
    listTemporary(temporary_);
    held_.reset(opendir(temporary_.c_str()));
    if (held_) flock(dirfd(held_.get()), LOCK_EX | LOCK_NB);
  }

  struct CloseFolder {
    void operator()(DIR* folder) const { closedir(folder); }
  };

  std::string folder_, temporary_;          // temporary_: empty once it is in its place
  std::unique_ptr<DIR, CloseFolder> held_;  // its lock tells others that somebody works on it
  int count_ = 0;
};

VideoWriter::VideoWriter(const std::string& path, int width, int height,
                         const VideoOptions& options)
    : width_(width), height_(height) {
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide ||
      !(options.frame_rate_hz > 0 && options.frame_rate_hz <= 1000)) {
    throw fileError(path, "a video of this size or frame rate cannot be written");
  }
  std::error_code error;
  const fs::path folder = fs::absolute(path, error).parent_path();
  if (!fs::is_directory(folder, error)) throw fileError(path, "the folder is missing");
  if (!findProgram(options.encoder).empty()) {
    auto file = std::make_unique<TemporaryFile>(path);
    if (std::optional<ChildProcess> process = ChildProcess::start(
            options.encoder, Encoder::arguments(width, height, options, isGif(path)),
            file->descriptor())) {
      sink_ = std::make_unique<Encoder>(std::move(*process), std::move(file), path);
      return;
    }
  }
  sink_ = std::make_unique<PngSequence>(path, options);
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const Image& frame) {
  const auto bytes = 4 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  if (frame.width != width_ || frame.height != height_ || frame.rgba.size() != bytes) {
    throw Error("a frame differs in size from the video");
  }
  sink_->add(frame);
}

void VideoWriter::finish() {
  sink_->finish();
}
bool VideoWriter::encodes() const {
  return sink_->encodes();
}
const std::string& VideoWriter::hint() const {
  return sink_->hint;
}

}  // namespace fascia
