// Threads that must wake up on time. They ask for real-time scheduling, and go on with normal scheduling if they run
// for too long without sleeping, so that they can neither stop a machine nor be killed for it. Afterwards, the process
// is as before: its limits, its handler of SIGXCPU, its locked memory, and the thread's scheduling.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string_view>
#include <utility>

namespace palpa {

/// The real-time priorities of the thread that hands drives over, of the guard of a board, which goes before it, and of
/// an emulated board, because a real one does not wait for this machine's processors.
inline constexpr int output_priority = 10, guard_priority = 11, emulated_priority = 12;

/// How the system schedules a thread. `favoured`: before others by its niceness.
enum class Scheduling { unknown, normal, favoured, real_time };

std::string_view to_text(Scheduling scheduling);

/// That of a thread of any process, by its number; 0 is the calling one.
Scheduling scheduling_of(pid_t thread);

/// While this exists, no page that the process already has is moved to a disk once it is in memory, if its limit
/// (RLIMIT_MEMLOCK) allows that. The last one unlocks all of the process's memory. A process that has locked memory by
/// itself is therefore left alone.
class KeptInMemory {
 public:
  /// `all`: reads in even those pages that were never used. This suits a small process.
  enum class Pages { used, all };
  explicit KeptInMemory(Pages pages = Pages::used);
  ~KeptInMemory();
  KeptInMemory(KeptInMemory&& other) noexcept : holds_(std::exchange(other.holds_, false)) {}
  KeptInMemory& operator=(KeptInMemory&&) = delete;

  bool holds() const { return holds_; }

 private:
  bool holds_ = false;
};

/// Asks a service of this computer for real-time scheduling of a thread of this or another process of the same user.
/// Returns at once if there is no service, and otherwise within a second.
using RealTimeService = std::function<void(pid_t process, pid_t thread, int priority)>;

/// A service grants it only to processes whose hard limit for it (RLIMIT_RTTIME) is at most 0.2 s. A process cannot
/// raise that again, and its children inherit it. palpa's own programs say at their start that theirs may be lowered.
/// In a program that only uses palpa as a library, a service is asked if that program has set such a limit itself.
void allow_lower_limit();

/// Whether the limit of a process leaves its threads enough time: at least 50 ms in real time without sleeping. With
/// less, the kernel could kill them before they are scheduled normally. 0 is the calling process.
bool has_time_for_real_time(pid_t process);

/// The calling thread is scheduled in real time while this exists, if the system allows it: by itself (root,
/// RLIMIT_RTPRIO), or through the service. If not, it is favoured as far as the system allows that (RLIMIT_NICE):
/// its niceness becomes -10, and so does that of the autogroup of its session, because niceness does not count between
/// sessions. If the thread runs for 0.1 s without sleeping, or for half its limit if that is less, it is scheduled
/// normally from then on. The kernel says so by SIGXCPU; where that means something else, the handler from before gets
/// it. Threads and processes that it starts do not inherit any of this, except for the soft limit of a program that is
/// started meanwhile, which counts only for that program's own threads in real time. Only for threads that mostly
/// sleep. At most eight at a time.
class RealTime {
 public:
  explicit RealTime(int priority, const RealTimeService& service = nullptr);
  /// Reverts all of it. The last one of the process restores its limit, except for a hard limit as above, and the
  /// handler of SIGXCPU, unless another has been installed.
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

 private:
  void ask(int priority, const RealTimeService& service);
  void favour();

  pid_t thread_;
  int before_ = 0, session_before_ = 0;  ///< niceness of thread and session
  bool listed_ = false, favoured_ = false, session_favoured_ = false;
  bool signal_was_blocked_ = false;
};

}  // namespace palpa
