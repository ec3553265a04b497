// Threads that work beside a loop.
#pragma once

namespace palpa::session {

/// Makes the calling thread, and those that it starts from now on, give way to all others: no real-time policy, which
/// it has from who started it, and nicer by ten. What is refused stays as it is.
void give_way();

/// Has the calling thread take no signals: those that the program catches are its main thread's.
void take_no_signals();

}  // namespace palpa::session
