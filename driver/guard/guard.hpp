// The guard: a separate process that holds a board, so that the board falls silent whatever happens to the loop.
//
//   a drive in every slot        it plays the newest (the heartbeat)
//   100 ms without a drive       all off; it stays, and plays again when drives return
//   10 ms, if the plan is over   the same
//   the end of its socket        the loop is gone, however it ended: all off, and it exits
//   SIGTERM, SIGQUIT             all off, and it exits; its loop ends, too
//   INT HUP PIPE TSTP TTIN TTOU  are for the loop, which ends in silence; the guard ignores them
//
// The guard has its own process session, so no terminal reaches it. docs/safety.md lists the cases in which it cannot
// help.
#pragma once

#include <span>

#include "driver/board.hpp"

namespace palpa::driver {

/// After this time without a drive, a board is silenced, whatever `--hold` says.
inline constexpr double heartbeat_s = 0.1;

/// A drive that no other drive follows sounds no longer than its plan may. If no drive has come for this time (or for
/// one and a half slots, if that is longer), a guard silences the board at the plan's end.
inline constexpr double unfollowed_s = 0.01;

/// Whether a board that sounds must be silenced. All times are on one clock: the newest drive came at `heard_s`, and
/// its plan may sound until `until_s`.
constexpr bool is_overdue(double now_s, double heard_s, double until_s, double slot_s) {
  const double unfollowed = 1.5 * slot_s > unfollowed_s ? 1.5 * slot_s : unfollowed_s;
  return now_s >= heard_s + heartbeat_s || (now_s >= until_s && now_s >= heard_s + unfollowed);
}

/// The descriptors under which a guard finds its loop's socket and the shared memory.
inline constexpr int guard_socket = 3, guard_memory = 4;

/// main() of a guard, with the boards that it knows. Allocates nothing once it has opened its board. If permitted, it
/// keeps its memory from being swapped out, and runs before other programs (niceness -10). Ends the process with 0 if
/// the last thing on the wire was all-off. It ends at once: its loop waits, and nothing that libraries do at a
/// program's end may delay it.
[[noreturn]] void guard_main(std::span<const BoardKind> kinds);

}  // namespace palpa::driver
