#include "base/system/real_time.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <ctime>
#include <functional>
#include <thread>

namespace palpa {
namespace {

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Runs `work` in a child, whose limits and rights it may spoil. Returns its exit code; minus its signal.
int in_child(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

bool may_be_real_time() {
  return in_child([] {
           const sched_param wish{.sched_priority = 1};
           return sched_setscheduler(0, SCHED_RR, &wish) == 0 ? 0 : 1;
         }) == 0;
}

/// Gives up the rights of root, and what its limits allow.
bool become_nobody() {
  const rlimit none{};
  return setrlimit(RLIMIT_RTPRIO, &none) == 0 && setrlimit(RLIMIT_NICE, &none) == 0 &&
         (getuid() != 0 || setresuid(65534, 65534, 65534) == 0);
}

TEST(RealTime, LastsAsLongAsItsThreadWantsAndIsNotInherited) {
  if (!may_be_real_time()) GTEST_SKIP() << "this user may not";
  const Scheduling before = scheduling_of(0);
  {
    const RealTime turns(output_priority);
    EXPECT_EQ(scheduling_of(0), Scheduling::real_time);
    sched_param now{};
    EXPECT_EQ(sched_getparam(0, &now), 0);
    EXPECT_EQ(now.sched_priority, output_priority);
    std::thread([&] { EXPECT_EQ(scheduling_of(0), Scheduling::normal) << "a thread that it starts"; }).join();
    EXPECT_EQ(in_child([] { return static_cast<int>(scheduling_of(0)); }), static_cast<int>(Scheduling::normal));
  }
  EXPECT_EQ(scheduling_of(0), before);
  EXPECT_GT(guard_priority, output_priority);
}

/// A thread that never sleeps is scheduled normally after 0.1 s of the processor's time, and goes on, again and again.
TEST(RealTime, ATurnThatIsTooLongEnds) {
  if (!may_be_real_time()) GTEST_SKIP() << "this user may not";
  for (const bool hard : {false, true}) {
    EXPECT_EQ(in_child([&] {
                if (hard) {
                  const rlimit limit{200'000, 200'000};  // as a service asks for: the kernel kills beyond it
                  setrlimit(RLIMIT_RTTIME, &limit);
                }
                for (int again = 0; again < 2; ++again) {
                  const RealTime turns(output_priority);
                  if (scheduling_of(0) != Scheduling::real_time) return 1;
                  const double begin_s = processor_s();
                  while (scheduling_of(0) == Scheduling::real_time)
                    if (processor_s() > begin_s + 5) return 2;
                  if (processor_s() < begin_s + 0.05) return 3;
                  while (processor_s() < begin_s + 0.5) {
                  }
                }
                return 0;
              }),
              0);
  }
}

TEST(RealTime, IsAskedForAtTheServiceOnlyIfTheSystemRefuses) {
  const auto asked = [](bool nobody) {
    return in_child([&] {
      if (nobody && !become_nobody()) return 9;
      int calls = 0;
      const RealTime turns(7, [&](pid_t process, pid_t thread, int priority) {
        rlimit limit{};
        getrlimit(RLIMIT_RTTIME, &limit);
        if (process == getpid() && thread == gettid() && priority == 7 && limit.rlim_max <= 200'000) ++calls;
      });
      if (nobody && scheduling_of(0) != Scheduling::normal) return 8;
      return calls;
    });
  };
  EXPECT_EQ(asked(true), 1);
  const int when_allowed = may_be_real_time() ? 0 : 1;
  EXPECT_EQ(asked(false), when_allowed);
}

TEST(RealTime, WithoutItAThreadIsFavouredIfTheSystemAllowsThatMuch) {
  constexpr rlimit none{}, most_nice{30, 30};
  if (in_child([&] { return setrlimit(RLIMIT_NICE, &most_nice) == 0 && getuid() == 0 ? 0 : 1; }) != 0)
    GTEST_SKIP() << "only root can allow it";
  EXPECT_EQ(in_child([&] {
              setsid();
              if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setrlimit(RLIMIT_NICE, &most_nice) != 0) return 9;
              if (setresuid(65534, 65534, 65534) != 0) return 8;
              {
                const RealTime turns(output_priority);
                if (scheduling_of(0) != Scheduling::favoured) return 1;
                if (getpriority(PRIO_PROCESS, 0) != -10) return 2;
              }
              return scheduling_of(0) == Scheduling::normal ? 0 : 3;
            }),
            0);
}

TEST(RealTime, NobodyIsScheduledUnknown) {
  EXPECT_EQ(scheduling_of(0), Scheduling::normal);
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  waitpid(gone, nullptr, 0);
  EXPECT_EQ(scheduling_of(gone), Scheduling::unknown);
  EXPECT_EQ(to_text(Scheduling::real_time), "real-time");
}

}  // namespace
}  // namespace palpa
