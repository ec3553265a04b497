// Priorities and signals of a program's threads. If threads need more cores than there are, a loop's threads go before
// the threads that work beside it.
#pragma once

#include <vector>

namespace palpa::session {

/// Gives precedence to the calling thread and to those that it starts from now on, by requesting short time slices. In
/// Linux 6.12 and later, a thread that wakes up takes the core of a thread with longer slices at once, not only when
/// that slice ends. This is for threads that wake up often and work for less than a frame's time: those of a loop and
/// of the software device that it computes on. It changes only the order; every thread's share stays the same. Older
/// kernels ignore it, and a real-time policy stays.
void go_first();

/// Reverts go_first(): slices of normal length, for a thread that was started by a thread with precedence.
void take_turns();

/// Makes the calling thread, and those that it starts from now on, yield to all others: no real-time policy, which it
/// may have inherited, a nice value higher by ten, and slices that any waking thread ends. Settings that the system
/// refuses stay as they are.
void give_way();

/// Does the same for an existing thread of this process, given by its number. A thread that has ended is ignored.
void give_way(int thread);

/// The threads of this process that are not among `before`, by their numbers, ascending.
std::vector<int> threads_since(const std::vector<int>& before = {});

/// Blocks signals in the calling thread: the main thread handles those that the program catches.
void take_no_signals();

}  // namespace palpa::session
