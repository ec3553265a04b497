#include "acoustics/boundary/blas.hpp"

#include <dlfcn.h>
#include <fmt/core.h>
#include <sched.h>
#include <sys/mman.h>

#include <cstdint>
#include <mutex>
#include <string>

#include "base/error.hpp"
#include "base/system/memory.hpp"

namespace palpa::acoustics {
namespace {

constexpr const char* library = "libopenblas.so.0";
// The address space that each calling thread needs: the library's own buffer, the thread's stack, and malloc's reserve.
constexpr std::uint64_t thread_bytes = (128u + 8u + 128u) << 20;
// The address space of the library itself.
constexpr std::uint64_t library_bytes = 64u << 20;

/// During its lifetime, this thread may run on one processor only. OpenBLAS starts a thread for each further processor
/// when it is loaded. An environment variable could prevent that, but other threads may be reading the environment.
class OneProcessor {
 public:
  OneProcessor() {
    if (sched_getaffinity(0, sizeof(before_), &before_) != 0) return;
    int first = 0;
    while (first < CPU_SETSIZE && !CPU_ISSET(first, &before_))
      ++first;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    narrowed_ = first < CPU_SETSIZE && sched_setaffinity(0, sizeof(one), &one) == 0;
  }
  ~OneProcessor() {
    if (narrowed_) sched_setaffinity(0, sizeof(before_), &before_);
  }
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;

 private:
  cpu_set_t before_;
  bool narrowed_ = false;
};

template <typename Function>
void find(void* handle, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(handle, name));
  if (!function) throw failure(fmt::format("{} has no {}: install libopenblas0-pthread", library, name));
}

/// Throws if this many bytes are not available now. OpenBLAS itself would retry for ever.
void expect_memory(std::uint64_t bytes) {
  void* const place = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (place == MAP_FAILED) {
    throw failure(
        fmt::format("factoring a matrix needs {} of memory, which is not available: raise the limit (ulimit -v)",
                    format_bytes(bytes)));
  }
  munmap(place, bytes);
}

Blas load() {
  expect_memory(library_bytes + thread_bytes);
  const OneProcessor one;
  void* const handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char* const reason = dlerror();
    throw failure(fmt::format("scattering needs OpenBLAS, which cannot be loaded ({}): install libopenblas0-pthread",
                              reason ? reason : library));
  }
  Blas functions{};
  find(handle, "cblas_cgemm", functions.cgemm);
  find(handle, "cblas_ctrsm", functions.ctrsm);
  find(handle, "cgetrf_", functions.cgetrf);
  find(handle, "cgetrs_", functions.cgetrs);
  find(handle, "claswp_", functions.claswp);
  // The threads are palpa's: the library's own threads would sum in another order for another number of threads.
  void (*set_num_threads)(int) = nullptr;
  find(handle, "openblas_set_num_threads", set_num_threads);
  set_num_threads(1);
  return functions;
}

}  // namespace

const Blas& blas(std::size_t threads) {
  static const Blas functions = load();
  // The library keeps a buffer for the next caller.
  static std::mutex mutex;
  static std::size_t provided = 0;
  const std::lock_guard lock(mutex);
  if (threads > provided) {
    expect_memory((threads - provided) * thread_bytes);
    provided = threads;
  }
  return functions;
}

}  // namespace palpa::acoustics
