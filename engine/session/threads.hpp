// What the threads of a program are to each other: whose turn it is where they want more cores than there are, a loop's
// before what works beside it, and who takes signals.
#pragma once

#include <vector>

namespace palpa::session {

/// Has the calling thread, and those that it starts from now on, go first: Linux 6.12 and later lets a thread that
/// wakes up have the core of one that asked for longer slices than its own, at once and not when that slice ends, and
/// these ask for short ones. For threads that wake up often and work for less than a frame takes: a loop's,
/// and the software device's that it computes on. It costs others nothing but the order: every thread's share stays as
/// it is. Older kernels pass it over, and a real-time policy stays.
void go_first();

/// Takes that back: slices as long as any thread's, for one that was started by a thread that goes first.
void take_turns();

/// Makes the calling thread, and those that it starts from now on, give way to all others: no real-time policy, which
/// it has from who started it, nicer by ten, and slices that whoever wakes up ends. What is refused stays as it is.
void give_way();

/// Makes a thread of this process that is there already do so, by its number; one that has ended is passed over.
void give_way(int thread);

/// The threads of this process that are not among `before`, by their numbers, ascending.
std::vector<int> threads_since(const std::vector<int>& before = {});

/// Has the calling thread take no signals: those that the program catches are its main thread's.
void take_no_signals();

}  // namespace palpa::session
