#pragma once

#include <cstddef>
#include <functional>
#include <type_traits>

namespace fascia {

// Limits how many threads parallelFor uses, for as long as it lives (one at a time, from main).
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);  // 0 = all the machine has
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

int hardwareThreads();
int threadLimit();  // how many threads parallelFor uses now

// Runs task(i) for i in [0, count). Tasks must not depend on each other or on their order, so that
// results have the same bits on any number of threads. Runs inline with one thread or one task.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& task);

// The same by reference: a task that captures much would be copied to the heap on every call.
template <class Task>
requires(!std::is_same_v<Task, std::function<void(std::size_t)>>) void parallelFor(
    std::size_t count, const Task& task) {
  parallelFor(count, std::function<void(std::size_t)>(std::cref(task)));
}

}  // namespace fascia
