#include <fascia/base/parallel.h>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <thread>

namespace fascia {

int hardwareThreads() {
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

ThreadLimit::ThreadLimit(int threads)
    : control_(new tbb::global_control(
          tbb::global_control::max_allowed_parallelism,
          static_cast<std::size_t>(threads > 0 ? threads : hardwareThreads()))) {}

ThreadLimit::~ThreadLimit() {
  delete static_cast<tbb::global_control*>(control_);
}

int threadLimit() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallelFor(std::size_t count, const std::function<void(std::size_t)>& task) {
  if (count <= 1 || threadLimit() <= 1) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return;
  }
  tbb::parallel_for(
      std::size_t{0}, count, [&](std::size_t i) { task(i); }, tbb::simple_partitioner{});
}

}  // namespace fascia
