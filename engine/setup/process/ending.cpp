#include "setup/process/ending.hpp"

#include <atomic>
#include <semaphore>

#include "base/log.hpp"

namespace palpa::setup {
namespace {

constexpr int undecided = -1;
std::atomic<int> decided{undecided};
std::binary_semaphore told{0};

}  // namespace

void begin_ending() {
  decided = undecided;
  told.try_acquire();
}

bool decide_ending(Exit code) {
  int expected = undecided;
  const bool decides = decided.compare_exchange_strong(expected, static_cast<int>(code));
  if (decides && code == Exit::ok) told.release();
  return decides;
}

void tell_ending(std::string_view line) {
  log::error(line);
  told.release();
}

void wait_for_line(std::chrono::milliseconds most) {
  if (told.try_acquire_for(most)) told.release();
}

Exit ending() {
  const int code = decided;
  return code == undecided ? Exit::ok : static_cast<Exit>(code);
}

}  // namespace palpa::setup
