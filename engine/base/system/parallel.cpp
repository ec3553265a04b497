#include "base/system/parallel.hpp"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "base/activity.hpp"
#include "base/system/start_thread.hpp"

namespace palpa {

unsigned worker_count() {
  cpu_set_t mine;
  CPU_ZERO(&mine);
  if (sched_getaffinity(0, sizeof(mine), &mine) == 0) return static_cast<unsigned>(std::max(CPU_COUNT(&mine), 1));
  return std::max(std::thread::hardware_concurrency(), 1U);
}

void parallel_chunks(std::size_t count, std::size_t size,
                     const std::function<void(std::size_t, std::size_t, std::size_t)>& work) {
  const std::size_t chunks = chunk_count(count, size);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  std::size_t failed = chunks;
  const std::atomic<bool>* const cancelled = cancel_flag();
  const auto run = [&] {
    for (;;) {
      const std::size_t chunk = next.fetch_add(1);
      if (chunk >= chunks) return;
      try {
        stop_if_cancelled(cancelled);
        work(chunk, chunk * size, std::min(count, (chunk + 1) * size));
      } catch (...) {
        next.store(chunks);
        const std::lock_guard lock(mutex);
        if (chunk < failed) {
          failed = chunk;
          error = std::current_exception();
        }
      }
    }
  };
  std::vector<std::thread> others;
  others.reserve(worker_count());
  const std::size_t helpers = std::min<std::size_t>(worker_count(), chunks);
  // If the system has no more threads, fewer do the same work.
  for (std::size_t i = 1; i < helpers; ++i) {
    std::thread other = try_thread(run);
    if (!other.joinable()) break;
    others.push_back(std::move(other));
  }
  run();
  for (std::thread& thread : others)
    thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace palpa
