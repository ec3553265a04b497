#include "setup/process/ending.hpp"

#include <fmt/core.h>

#include <atomic>
#include <cstring>
#include <semaphore>
#include <string>

#include "base/log.hpp"
#include "session/links/board_sound.hpp"

namespace palpa::setup {
namespace {

constexpr int undecided = -1;
std::atomic<int> decided{undecided};
std::binary_semaphore told{0};
std::atomic<int> cut_short_by{0};
static_assert(std::atomic<int>::is_always_lock_free);

}  // namespace

void begin_ending() {
  decided = undecided;
  cut_short_by = 0;
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

void note_cut_short(int by_signal) {
  cut_short_by = by_signal;
}

void decide_good_ending() {
  const int signal = cut_short_by;
  const std::string boards = session::boards_that_may_sound();
  if (signal == 0 && boards.empty()) {
    decide_ending(Exit::ok);
  } else if (decide_ending(Exit::failed)) {
    const char* const name = sigdescr_np(signal);
    tell_ending(signal == 0 ? "ended, but " + boards
                            : fmt::format("cut short by signal {} ({})", signal, name != nullptr ? name : "real-time"));
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
