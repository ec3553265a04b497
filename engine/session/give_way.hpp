// Threads that work beside a loop.
#pragma once

namespace palpa::session {

/// Makes the calling thread give way to all others: no real-time policy, which it has from who started it, and nicer by
/// ten. What is refused stays as it is. And to take no signals.
void give_way();

}  // namespace palpa::session
