#include <fascia/base/parallel.h>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <thread>
#include <vector>

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

#ifdef __SANITIZE_THREAD__
namespace {

// The thread sanitizer sees no order in what oneTBB hands from thread to thread, for that library
// is not built with it, and takes all of it for races. It sees that of plain threads.
void runAll(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) task(i);
  };
  std::vector<std::jthread> threads;
  for (int t = 1; t < threadLimit(); ++t) threads.emplace_back(work);
  work();
}

}  // namespace
#else
namespace {

void runAll(std::size_t count, const std::function<void(std::size_t)>& task) {
  tbb::parallel_for(
      std::size_t{0}, count, [&](std::size_t i) { task(i); }, tbb::simple_partitioner{});
}

}  // namespace
#endif

void parallelFor(std::size_t count, const std::function<void(std::size_t)>& task) {
  if (count <= 1 || threadLimit() <= 1) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return;
  }
  runAll(count, task);
}

}  // namespace fascia
