#include <fascia/track/stream_source.h>

#include <algorithm>
#include <utility>

namespace fascia {

StreamSource::StreamSource(const Figure& figure, const StreamOptions& options)
    : figure_(figure),
      delay_s_(options.delay_s),
      frames_(figure, options.capacity, options.coast_s),
      offset_(figure, options.catch_up_s),
      waiting_(std::max<std::size_t>(options.capacity, 4)),
      taken_(waiting_.size()) {}

void StreamSource::push(double time_s, const PostureSample& sample) {
  const std::lock_guard lock(mutex_);
  if (waitingCount_ == waiting_.size()) {
    waitingFirst_ = (waitingFirst_ + 1) % waiting_.size();
    --waitingCount_;
  }
  Arrival& arrival = waiting_[(waitingFirst_ + waitingCount_) % waiting_.size()];
  arrival.time_s = time_s;
  arrival.sample = sample;
  ++waitingCount_;
}

std::size_t StreamSource::receive(double now_s) {
  std::size_t first = 0, count = 0;
  {
    const std::lock_guard lock(mutex_);
    std::swap(waiting_, taken_);
    first = std::exchange(waitingFirst_, 0);
    count = std::exchange(waitingCount_, 0);
  }
  if (count == 0) return 0;
  const bool started = !frames_.empty();
  if (started) sampleFit(*this, figure_, now_s, before_);
  for (std::size_t i = 0; i < count; ++i) {
    const Arrival& arrival = taken_[(first + i) % taken_.size()];
    frames_.put(arrival.time_s, arrival.sample);
  }
  if (!started) return count;
  sampleRaw(now_s, after_);
  offset_.start(now_s, before_, after_);
  return count;
}

void StreamSource::sampleRaw(double time_s, PostureSample& out) const {
  frames_.sample(time_s - delay_s_, out);
}

void StreamSource::sample(double time_s, PostureSample& out) const {
  sampleRaw(time_s, out);
  offset_.apply(time_s, out);
}

}  // namespace fascia
