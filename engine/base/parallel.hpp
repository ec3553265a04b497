// Work cut into chunks and done by as many threads as the machine has.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace palpa {

/// Threads that parallel_chunks() uses: what the process may run on, at least one.
unsigned worker_count();

/// Calls `work(chunk, begin, end)` for the chunks 0, 1, ... of `count` items, `size` items each (the last one fewer),
/// on worker_count() threads, the calling one among them. Chunks are begun in ascending order. Results that go by chunk
/// are the same for any number of threads. An exception ends the handing out of chunks and is thrown here; of several,
/// that of the lowest chunk.
void parallel_chunks(std::size_t count, std::size_t size,
                     const std::function<void(std::size_t chunk, std::size_t begin, std::size_t end)>& work);

/// Thrown where work ends because nobody wants it any more.
struct GivenUp {};
/// Between the steps of long work: throws GivenUp if `give_up`, which may be null, became true.
inline void stop_if(const std::atomic<bool>* give_up) {
  if (give_up && *give_up) throw GivenUp();
}

inline std::size_t chunk_count(std::size_t count, std::size_t size) {
  return (count + size - 1) / size;
}

}  // namespace palpa
