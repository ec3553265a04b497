// How a program ends. Two threads may decide this at the same time: the one that did its work, and the watch for
// signals (setup/process/interrupt.hpp). The first one decides, so that the exit code and the line on stderr always
// agree.
#pragma once

#include <chrono>
#include <string_view>

#include "base/error.hpp"

namespace palpa::setup {

/// A program begins: nothing is decided. Tests run several programs in one process.
void begin_ending();
/// The program ends with `code`, unless another thread has already decided. Returns whether this call decided. Then the
/// caller passes the line that belongs to the code, unless it is Exit::ok.
bool decide_ending(Exit code);
/// Logs that line as an error, with what is known of the boards' sound.
void tell_ending(std::string_view line);
/// A signal has ended the work that nobody sends for that, such as a limit of processor time. Safe in a signal handler.
void note_cut_short(int by_signal);
/// The work is done: decides Exit::ok, or Exit::failed with its line if it was cut short or a board may still sound.
void decide_good_ending();
/// Waits until it is written, for that long at most.
void wait_for_line(std::chrono::milliseconds most);
/// What was decided; Exit::ok if nothing is.
Exit ending();

}  // namespace palpa::setup
