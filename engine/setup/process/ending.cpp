#include "setup/process/ending.hpp"

#include <atomic>
#include <semaphore>
#include <string>

#include "base/log.hpp"
#include "session/links/board_sound.hpp"

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
  log::error(session::with_board_sounds(line));
  told.release();
}

void decide_good_ending() {
  const std::string boards = session::boards_that_may_sound();
  if (boards.empty()) {
    decide_ending(Exit::ok);
  } else if (decide_ending(Exit::failed)) {
    tell_ending("ended, but " + boards);
  }
}

void wait_for_line(std::chrono::milliseconds most) {
  if (told.try_acquire_for(most)) told.release();
}

Exit ending() {
  const int code = decided;
  return code == undecided ? Exit::ok : static_cast<Exit>(code);
}

}  // namespace palpa::setup
