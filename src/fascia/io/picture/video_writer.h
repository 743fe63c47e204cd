#pragma once

#include <memory>
#include <string>

#include <fascia/io/picture/image.h>

namespace fascia {

struct VideoOptions {
  double frame_rate_hz = 30;
  int crf = 18;                    // x264's constant rate factor: 0 lossless, 18 looks it, 51 worst
  std::string encoder = "ffmpeg";  // the program, looked for in PATH
};

// H.264 in MP4, or a GIF that repeats for ever if the path ends in .gif, through the ffmpeg
// program. A GIF's frames are kept in ffmpeg's memory until all of its colours are known. Where
// there is none: numbered PNG files in a folder named after the video, and a hint how to join them.
// The video appears only when finish() succeeds.
class VideoWriter {
 public:
  VideoWriter(const std::string& path, int width, int height, const VideoOptions& options = {});
  ~VideoWriter();  // without finish(): nothing is left behind

  void add(const Image& frame);  // width x height; throws Error
  void finish();                 // throws Error with what ffmpeg said

  bool encodes() const;             // false: PNG sequence
  const std::string& hint() const;  // what to tell the person; empty if all went as asked

 private:
  class Sink;
  class Encoder;
  class PngSequence;
  std::unique_ptr<Sink> sink_;
  int width_, height_;
};

}  // namespace fascia
