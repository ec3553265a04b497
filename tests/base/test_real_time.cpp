#include "base/system/real_time.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/locked_memory.hpp"

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
                  while (processor_s() < begin_s + 0.3) {  // longer than the hard limit
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
      allow_lower_limit();
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

/// What a process is like, as far as threads in real time may change it.
struct ProcessState {
  rlim_t soft = 0, hard = 0;
  void (*handler)(int) = nullptr;
  bool blocks = false;
  Scheduling scheduling = Scheduling::unknown;
  long locked = 0;
  bool operator==(const ProcessState&) const = default;
};

ProcessState process_state() {
  rlimit limit{};
  getrlimit(RLIMIT_RTTIME, &limit);
  struct sigaction action {};
  sigaction(SIGXCPU, nullptr, &action);
  sigset_t blocked;
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  return {limit.rlim_cur,   limit.rlim_max,    action.sa_handler, sigismember(&blocked, SIGXCPU) == 1,
          scheduling_of(0), test::locked_kib()};
}

volatile std::sig_atomic_t signals_of_the_host = 0;

void count_signal(int) {
  signals_of_the_host = signals_of_the_host + 1;
}

void block(int signal) {
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, signal);
  pthread_sigmask(SIG_BLOCK, &one, nullptr);
}

TEST(RealTime, LeavesItsProcessAsItWas) {
  for (const bool nobody : {false, true}) {
    for (const bool has_handler : {false, true}) {
      EXPECT_EQ(in_child([&] {
                  if (has_handler) {
                    std::signal(SIGXCPU, count_signal);
                    block(SIGXCPU);
                    const rlimit own{900'000, RLIM_INFINITY};
                    setrlimit(RLIMIT_RTTIME, &own);
                  }
                  if (nobody && !become_nobody()) return 9;
                  const ProcessState before = process_state();
                  for (int run = 0; run < 2; ++run) {  // in a row
                    const KeptInMemory kept;
                    const RealTime turns(output_priority, [](pid_t, pid_t, int) {});
                    if (process_state().handler == before.handler) return 1;
                  }
                  if (process_state() != before) return 2;
                  std::optional<KeptInMemory> kept(std::in_place), kept_too(std::in_place);  // two at once
                  std::optional<RealTime> turns(std::in_place, output_priority), more(std::in_place, output_priority);
                  kept.reset();
                  turns.reset();
                  const ProcessState meanwhile = process_state();
                  if (meanwhile.handler == before.handler || (kept_too->holds() && meanwhile.locked == 0)) return 3;
                  more.reset();
                  kept_too.reset();
                  return process_state() == before ? 0 : 4;
                }),
                0)
          << nobody << has_handler;
    }
  }
}

TEST(RealTime, AForkBeginsAsItsProcessWas) {
  EXPECT_EQ(in_child([] {
              const ProcessState before = process_state();
              std::thread thread([&] {
                const RealTime turns(output_priority);
                const int code = in_child([&] {
                  const ProcessState now = process_state();
                  return now.soft == before.soft && now.handler == before.handler ? 0 : 1;
                });
                if (code != 0) _exit(code);
              });
              thread.join();
              return process_state() == before ? 0 : 2;
            }),
            0);
}

TEST(RealTime, AnEarlierHandlerIsToldToo) {
  EXPECT_EQ(in_child([] {
              std::signal(SIGXCPU, count_signal);
              {
                const RealTime turns(output_priority);
                raise(SIGXCPU);
                if (scheduling_of(0) == Scheduling::real_time) return 1;
                if (signals_of_the_host != 1) return 2;
              }
              raise(SIGXCPU);
              return signals_of_the_host == 2 ? 0 : 3;
            }),
            0);
}

TEST(RealTime, ATurnThatIsTooLongIsNoMatterOfAnEarlierHandler) {
  if (!may_be_real_time()) GTEST_SKIP() << "this user may not";
  EXPECT_EQ(in_child([] {
              std::signal(SIGXCPU, count_signal);
              const RealTime turns(output_priority);
              const double begin_s = processor_s();
              while (scheduling_of(0) == Scheduling::real_time)
                if (processor_s() > begin_s + 5) return 1;
              if (signals_of_the_host != 0) return 2;
              const rlimit second{1, RLIM_INFINITY};  // of the processor's time, which is almost used
              setrlimit(RLIMIT_CPU, &second);
              while (signals_of_the_host == 0)
                if (processor_s() > begin_s + 5) return 3;
              return 0;
            }),
            0);
}

/// A hard limit cannot be raised again, so a program that only uses palpa as a library keeps its own.
TEST(RealTime, AServiceIsAskedOnlyWhereItsLimitMayStay) {
  const auto asked = [](const rlimit& own, bool may_lower, rlim_t expected) {
    return in_child([&] {
      setrlimit(RLIMIT_RTTIME, &own);
      if (!become_nobody()) return 9;
      if (may_lower) allow_lower_limit();
      int calls = 0;
      {
        const RealTime turns(7, [&](pid_t, pid_t, int) { ++calls; });
      }
      rlimit limit{};
      getrlimit(RLIMIT_RTTIME, &limit);
      return limit.rlim_max == expected && limit.rlim_cur == std::min(own.rlim_cur, expected) ? calls : 8;
    });
  };
  constexpr rlim_t none = RLIM_INFINITY;
  EXPECT_EQ(asked({none, none}, false, none), 0);
  EXPECT_EQ(asked({150'000, 150'000}, false, 150'000), 1) << "this program has asked for it";
  EXPECT_EQ(asked({none, none}, true, 200'000), 1) << "a program of palpa's own";
}

/// The kernel would kill it.
TEST(RealTime, IsNotAskedForWithALimitThatLeavesNoTime) {
  for (const rlim_t us : {1'000, 49'000, 50'000}) {
    const bool enough = us >= 50'000;
    EXPECT_EQ(in_child([&] {
                const rlimit own{us, us};
                setrlimit(RLIMIT_RTTIME, &own);
                if (has_time_for_real_time(0) != enough) return 1;
                const RealTime turns(output_priority);
                if (!enough && scheduling_of(0) == Scheduling::real_time) return 2;
                rlimit now{};
                getrlimit(RLIMIT_RTTIME, &now);
                if (enough && now.rlim_cur != us / 2) return 3;
                const double begin_s = processor_s();
                while (processor_s() < begin_s + 0.1) {  // longer than any of them
                }
                return 0;
              }),
              0)
        << us;
  }
}

TEST(KeptInMemory, UnlocksOnlyWhatItLocked) {
  EXPECT_EQ(in_child([] {
              const std::vector<char> own(1 << 16);
              if (!KeptInMemory().holds()) return 7;
              if (test::locked_kib() != 0) return 1;
              KeptInMemory first(KeptInMemory::Pages::all);
              if (test::locked_kib() == 0) return 2;
              {
                const KeptInMemory moved(std::move(first));
                if (first.holds() || !moved.holds()) return 3;  // NOLINT(bugprone-use-after-move)
              }
              if (test::locked_kib() != 0) return 4;
              if (mlock(own.data(), own.size()) != 0) return 7;
              const long before = test::locked_kib();
              { const KeptInMemory none; }
              return before > 0 && test::locked_kib() == before ? 0 : 5;
            }) % 7,
            0);  // 7: this machine locks nothing
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
