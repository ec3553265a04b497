// The guard: a process of its own that holds a board, so that the board falls silent whatever becomes of the loop.
//
//   a drive in every slot        it plays the newest (the heartbeat)
//   100 ms without one           all off; it stays, and plays again when drives return
//   10 ms, and its plan is over  the same
//   the end of its socket        the loop is gone, however it ended: all off, and it leaves
//   SIGTERM, SIGQUIT             all off, and it leaves; its loop ends, too
//   INT HUP PIPE TSTP TTIN TTOU  are for the loop, which ends in silence; the guard takes no notice
//
// It has a session of its own, so no terminal reaches it. docs/safety.md tells what it cannot protect from.
#pragma once

#include <span>

#include "driver/board.hpp"

namespace palpa::driver {

/// After so long without a drive a board is silenced, whatever `--hold` says.
inline constexpr double heartbeat_s = 0.1;

/// A drive that nobody follows up sounds no longer than its plan may: so long after the newest drive, or one and a half
/// slots, a guard takes the plan's end for the end.
inline constexpr double unfollowed_s = 0.01;

/// Whether a board that sounds is to be silenced. All times on one clock: the newest drive came at `heard_s`, and its
/// plan may sound until `until_s`.
constexpr bool is_overdue(double now_s, double heard_s, double until_s, double slot_s) {
  const double unfollowed = 1.5 * slot_s > unfollowed_s ? 1.5 * slot_s : unfollowed_s;
  return now_s >= heard_s + heartbeat_s || (now_s >= until_s && now_s >= heard_s + unfollowed);
}

/// Where a guard finds its loop's socket and the shared memory.
inline constexpr int guard_socket = 3, guard_memory = 4;

/// main() of a guard, with the boards that it knows. Allocates nothing once it has opened its board, and where
/// that is allowed keeps its memory from being swapped out and goes before other programs (niceness -10). Ends the
/// process with 0 where the last thing on the wire was all-off, and at once: its loop waits, and nothing that libraries
/// do at a program's end may keep it.
[[noreturn]] void guard_main(std::span<const BoardKind> kinds);

}  // namespace palpa::driver
