#include <fascia/io/picture/video_writer.h>

#include <cctype>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <fascia/base/error.h>
#include <fascia/io/file/child_process.h>

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
  Encoder(ChildProcess process, std::string path, std::string temporary)
      : process_(std::move(process)), path_(std::move(path)), temporary_(std::move(temporary)) {}
  ~Encoder() override {
    process_.reset();  // must have stopped writing before the file goes
    std::error_code ignored;
    if (!done_) fs::remove(temporary_, ignored);
  }

  static std::vector<std::string> arguments(int width, int height, const VideoOptions& options,
                                            const std::string& output, bool gif) {
    std::vector<std::string> all{"-nostdin", "-loglevel", "error", "-y",
                                 // in
                                 "-f", "rawvideo", "-pixel_format", "rgba", "-video_size",
                                 std::to_string(width) + "x" + std::to_string(height), "-framerate",
                                 decimal(options.frame_rate_hz), "-i", "pipe:0"};
    const std::vector<std::string> out = gif ? gifArguments() : mp4Arguments(options.crf);
    all.insert(all.end(), out.begin(), out.end());
    all.push_back("file:" + output);
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
    if (process_->write(frame.rgba.data(), frame.rgba.size())) return;
    process_->finish();
    throw fileError(path_, "the video cannot be encoded: " + process_->complaints());
  }
  void finish() override {
    if (!process_->finish()) {
      throw fileError(path_, "the video cannot be encoded: " + process_->complaints());
    }
    std::error_code error;
    fs::rename(temporary_, path_, error);
    if (error) throw fileError(path_, "cannot be put in its place: " + error.message());
    done_ = true;
  }
  bool encodes() const override { return true; }

 private:
  std::optional<ChildProcess> process_;
  std::string path_, temporary_;
  bool done_ = false;
};

// clip.mp4 -> clip/00000.png …; built under another name and renamed like a file.
class VideoWriter::PngSequence final : public Sink {
 public:
  PngSequence(const std::string& path, const VideoOptions& options) {
    const fs::path file(path);
    folder_ = (file.parent_path() / file.stem()).string();
    if (!file.has_extension()) folder_ += "-frames";
    temporary_ = folder_ + ".tmp";
    std::error_code error;
    if (fs::exists(folder_, error))
      throw fileError(folder_, "is in the way of the picture sequence");
    fs::remove_all(temporary_, error);
    if (!fs::create_directories(temporary_, error)) {
      throw fileError(temporary_, "cannot be made: " + error.message());
    }
    hint = "the program " + options.encoder + " was not found, so the frames are PNG files in " +
           folder_ + "; to join them: ffmpeg -framerate " + decimal(options.frame_rate_hz) +
           " -i " + folder_ + "/%05d.png " + (isGif(path) ? "" : "-pix_fmt yuv420p ") + path;
  }
  ~PngSequence() override {
    std::error_code ignored;
    if (!done_) fs::remove_all(temporary_, ignored);
  }

  void add(const Image& frame) override {
    char name[24];
    std::snprintf(name, sizeof name, "/%05d.png", count_++);
    writePng(frame, temporary_ + name);
  }
  void finish() override {
    std::error_code error;
    fs::rename(temporary_, folder_, error);
    if (error) throw fileError(folder_, "cannot be put in its place: " + error.message());
    done_ = true;
  }
  bool encodes() const override { return false; }

 private:
  std::string folder_, temporary_;
  int count_ = 0;
  bool done_ = false;
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
  const std::string temporary = path + ".tmp";
  if (std::optional<ChildProcess> process = ChildProcess::start(
          options.encoder, Encoder::arguments(width, height, options, temporary, isGif(path)))) {
    sink_ = std::make_unique<Encoder>(std::move(*process), path, temporary);
  } else {
    sink_ = std::make_unique<PngSequence>(path, options);
  }
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
