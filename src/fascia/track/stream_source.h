#pragma once

#include <mutex>
#include <vector>

#include <fascia/track/posture_frames.h>
#include <fascia/track/posture_offset.h>

namespace fascia {

struct StreamOptions {
  double delay_s = 0;       // ≥ 0; shown so much later than stamped: a device's jitter fits in it
  double coast_s = 0.1;     // ≥ 0; where postures are missing it goes on so long, then stands
  double catch_up_s = 0.1;  // > 0; how soon it is where it should be after a gap
  std::size_t capacity = 64;  // postures that are kept, and that may wait; at least 4
};

// Postures that come from outside while a character is advanced: from motion capture, another
// program, another machine. Any thread pushes; the one that advances takes in what has come,
// between frames, so that a frame sees one motion.
class StreamSource final : public PostureSource {
 public:
  explicit StreamSource(const Figure& figure, const StreamOptions& options = {});

  // From any thread. A stamp is a time of the character's; postures may come late or in any order.
  // Where more wait than there is room, the oldest are lost. Rates are not read.
  void push(double time_s, const PostureSample& sample);

  // Takes in what has come; now_s: the time that the next frame starts at, where the motion goes on
  // without a jump. Returns how many postures there were.
  std::size_t receive(double now_s);

  void sample(double time_s, PostureSample& out) const override;

 private:
  struct Arrival {
    double time_s = 0;
    PostureSample sample;
  };
  void sampleRaw(double time_s, PostureSample& out) const;

  Figure figure_;
  double delay_s_;
  PostureFrames frames_;
  PostureOffset offset_;
  PostureSample before_, after_;  // scratch

  std::mutex mutex_;  // of the two below
  std::vector<Arrival> waiting_;
  std::size_t waitingFirst_ = 0, waitingCount_ = 0;
  std::vector<Arrival> taken_;
};

}  // namespace fascia
