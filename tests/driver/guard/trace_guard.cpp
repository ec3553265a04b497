// A guard that knows the tests' board and counts its own allocations.
#include <atomic>
#include <cstdlib>
#include <new>

#include "driver/guard/guard.hpp"
#include "trace_board.hpp"

namespace {

std::atomic<std::uint64_t> count{0};

void* take(std::size_t size) {
  ++count;
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) std::abort();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  return take(size);
}
void* operator new[](std::size_t size) {
  return take(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

std::uint64_t palpa::test::allocations() {
  return count;
}

int main() {
  const palpa::driver::BoardKind boards[]{palpa::test::trace_board()};
  palpa::driver::guard_main(boards);
}
