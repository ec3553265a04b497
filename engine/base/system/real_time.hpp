// Threads that must wake up on time. They ask for real-time scheduling, and go on with normal scheduling if they run
// for too long without sleeping, so that they can neither stop a machine nor be killed for it.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string_view>

namespace palpa {

/// The real-time priorities of the thread that hands drives over, of the guard of a board, which goes before it, and of
/// an emulated board, because a real one does not wait for this machine's processors.
inline constexpr int output_priority = 10, guard_priority = 11, emulated_priority = 12;

/// How the system schedules a thread. `favoured`: before others by its niceness.
enum class Scheduling { unknown, normal, favoured, real_time };

std::string_view to_text(Scheduling scheduling);

/// That of a thread of any process, by its number; 0 is the calling one.
Scheduling scheduling_of(pid_t thread);

/// From now on, no page that this process already has is moved to a disk once it is in memory. False if its limit
/// (RLIMIT_MEMLOCK) does not allow that.
bool keep_in_memory();

/// Asks a service of this computer for real-time scheduling of a thread of this or another process of the same user.
/// Returns at once if there is no service, and otherwise within a second.
using RealTimeService = std::function<void(pid_t process, pid_t thread, int priority)>;

/// The calling thread is scheduled in real time while this exists, if the system allows it: by itself (root,
/// RLIMIT_RTPRIO), or through the service. If not, it is favoured as far as the system allows that (RLIMIT_NICE):
/// its niceness becomes -10, and so does that of the autogroup of its session, because niceness does not count between
/// sessions. If the thread runs for 0.1 s without sleeping, it is scheduled normally from then on. Threads and
/// processes that it starts do not inherit any of this. Only for threads that mostly sleep. At most eight at a time.
class RealTime {
 public:
  explicit RealTime(int priority, const RealTimeService& service = nullptr);
  /// Reverts all of it.
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

 private:
  void favour();

  pid_t thread_;
  int before_ = 0, session_before_ = 0;  ///< niceness of thread and session
  bool favoured_ = false, session_favoured_ = false;
};

}  // namespace palpa
