#include "base/system/kept_from_forks.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>

namespace palpa {
namespace {

/// Descriptors plus one; 0 is a free place. Another thread may hold any lock when fork() comes, so there is none.
std::array<std::atomic<int>, 256> kept{};

void replace_in_child() {
  const int before = errno;
  const int idle = eventfd(0, EFD_CLOEXEC);
  for (std::atomic<int>& place : kept) {
    const int descriptor = place.exchange(0) - 1;
    if (descriptor < 0) continue;
    // Its number stays taken, because its owner may still close it.
    if (idle < 0 || dup3(idle, descriptor, O_CLOEXEC) < 0) close(descriptor);
  }
  if (idle >= 0) close(idle);
  errno = before;
}

}  // namespace

KeptFromForks::KeptFromForks(int descriptor) : descriptor_(descriptor) {
  static const int handled = pthread_atfork(nullptr, nullptr, replace_in_child);
  if (handled != 0 || descriptor < 0) return;
  for (std::atomic<int>& place : kept) {
    int free = 0;
    if (place.compare_exchange_strong(free, descriptor + 1)) return;
  }
}

KeptFromForks::~KeptFromForks() {
  for (std::atomic<int>& place : kept) {
    int mine = descriptor_ + 1;
    if (place.compare_exchange_strong(mine, 0)) return;
  }
}

}  // namespace palpa
