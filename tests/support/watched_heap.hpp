// Counts the allocations of the thread under test while it is watched. It replaces the program's operator new. Several
// sources of a program may include it, in one unit (units.py) or in several: its operators are weak.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

namespace palpa::test {

inline thread_local bool heap_watched = false;
inline thread_local std::size_t heap_allocations = 0;

/// The number of allocations of `work` on this thread; always 0 under sanitizers, which replace the heap.
template <typename Work>
std::size_t allocations_of(const Work& work) {
  heap_allocations = 0;
  heap_watched = true;
  work();
  heap_watched = false;
  return heap_allocations;
}

}  // namespace palpa::test

#if !defined(PALPA_ADDRESS_SANITIZER) && !defined(PALPA_THREAD_SANITIZER)
// Not inlined: a compiler that sees only one half of a pair reports malloc and delete as a mismatch.
[[gnu::noinline, gnu::weak]] void* operator new(std::size_t size) {
  if (palpa::test::heap_watched) ++palpa::test::heap_allocations;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline, gnu::weak]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline, gnu::weak]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
#endif
