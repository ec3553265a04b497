// Work that is split into chunks and done by all threads of the machine.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace palpa {

/// Number of threads that parallel_chunks() uses: the processors that the process may run on, at least one.
unsigned worker_count();

/// Calls `work(chunk, begin, end)` for the chunks 0, 1, ... of `count` items, `size` items each (the last one fewer),
/// on worker_count() threads, including the calling thread. Chunks begin in ascending order. Results stored per chunk
/// are the same for any number of threads. After an exception no further chunk begins, and the exception is rethrown
/// here; of several, that of the lowest chunk. If the calling thread is Cancellable (base/activity.hpp) and was
/// cancelled, no further chunk begins, and failure() is thrown.
void parallel_chunks(std::size_t count, std::size_t size,
                     const std::function<void(std::size_t chunk, std::size_t begin, std::size_t end)>& work);

/// Thrown to end work whose result is no longer wanted.
struct GivenUp {};
/// For use between the steps of long work: throws GivenUp if `give_up`, which may be null, is true.
inline void stop_if(const std::atomic<bool>* give_up) {
  if (give_up && *give_up) throw GivenUp();
}

inline std::size_t chunk_count(std::size_t count, std::size_t size) {
  return (count + size - 1) / size;
}

}  // namespace palpa
