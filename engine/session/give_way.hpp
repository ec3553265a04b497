// Threads that work beside a loop.
#pragma once

#include <vector>

namespace palpa::session {

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
