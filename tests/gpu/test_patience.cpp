#include "gpu/patience.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "gpu/software.hpp"
#include "support/device.hpp"
#include "support/thrown.hpp"

namespace palpa::gpu {
namespace {

using Work = std::vector<ThreadWork>;

/// Waits in slices of `slice_s`. After each slice, `work` gives the threads' work so far. Ends when patience ends or
/// `longest_s` have passed; returns the seconds of real time.
template <typename Function>
double waits(Patience& patience, double slice_s, double longest_s, const Function& work) {
  double now_s = 0;
  while (now_s < longest_s) {
    now_s += slice_s;
    if (patience.ends(slice_s, work(now_s))) break;
  }
  return now_s;
}

TEST(Patience, AGpuHasAMinute) {
  Patience patience(60, false);
  EXPECT_EQ(patience.slice_s(), 1);
  EXPECT_EQ(waits(patience, 1, 1000, [](double) { return Work{}; }), 60);
  EXPECT_EQ(patience.reason(), "no answer within 60 s; another program may be using the GPU");
}

// SIGSTOP, or a suspended virtual machine: when it continues, the device has had no more time than the program.
TEST(Patience, TimeInWhichTheProgramStoodStillDoesNotCount) {
  for (const bool software : {false, true}) {
    Patience patience(60, software);
    const Work asleep(2);
    EXPECT_FALSE(patience.ends(1, asleep));
    EXPECT_FALSE(patience.ends(3600, asleep));
    EXPECT_FALSE(patience.ends(1, asleep));
  }
}

// Ten cold starts at once: each driver's threads get a sixteenth of a processor, and compile shaders for 20 s of
// processor time.
TEST(Patience, ASoftwareDeviceThatComputesIsWaitedFor) {
  Patience patience(60, true);
  EXPECT_EQ(waits(patience, 1, 320, [](double now_s) { return Work{{now_s / 16, true}, {0.1, false}}; }), 320);
}

// A background shell on a machine that is busy with more urgent work: ready to run, but it does not get a processor.
TEST(Patience, AThreadThatWaitsForAProcessorIsAlive) {
  Patience patience(60, true);
  EXPECT_EQ(waits(patience, 1, 600, [](double) { return Work{{5, true}, {0.1, false}}; }), 600);
}

TEST(Patience, ASoftwareDeviceThatComputesForEverIsGivenUp) {
  Patience patience(60, true);
  EXPECT_NEAR(waits(patience, 1, 1000, [](double now_s) { return Work{{now_s / 2, true}, {0, false}}; }), 121, 1);
  EXPECT_EQ(patience.reason(), "no answer within 60 s of processor time");
}

// The busiest thread counts, not the sum of all: the sum would reach a minute sooner on a machine of many cores.
TEST(Patience, AMinuteOfAllCoresIsAMinute) {
  Patience patience(60, true);
  EXPECT_NEAR(waits(patience, 1, 1000, [](double now_s) { return Work(32, {now_s, true}); }), 61, 1);
}

TEST(Patience, ASoftwareDeviceWhoseThreadsSleepIsGivenUp) {
  Patience patience(60, true);
  EXPECT_NEAR(waits(patience, 1, 1000, [](double) { return Work{{5, false}, {0.1, false}}; }), 61, 1);
  EXPECT_EQ(patience.reason(), "no answer within 60 s, in which its threads did nothing");
}

TEST(Patience, ProgressAfterAPauseIsProgress) {
  Patience patience(60, true);
  const auto work = [](double now_s) { return Work{{now_s < 50 ? 1 : 1.5, false}}; };
  EXPECT_NEAR(waits(patience, 1, 1000, work), 110, 2);
}

TEST(Patience, LooksAtShortWaitsOften) {
  EXPECT_DOUBLE_EQ(Patience(0.2, true).slice_s(), 0.05);
}

TEST(Patience, KnowsWhatThreadsOfThisProcessDo) {
  std::atomic<bool> stop{false};
  std::atomic<int> busy_id{0}, idle_id{0};
  std::thread busy([&] {
    busy_id = gettid();
    while (!stop) {
    }
  });
  std::thread idle([&] {
    idle_id = gettid();
    stop.wait(false);
  });
  while (busy_id == 0 || idle_id == 0)
    std::this_thread::yield();
  const std::vector<int> threads{busy_id, idle_id};
  const std::vector<int> all = threads_of_process();
  for (const int thread : threads)
    EXPECT_TRUE(std::binary_search(all.begin(), all.end(), thread));
  const Work before = work_of(threads);
  // However busy the machine is: wait until it has computed for a while.
  while (work_of(threads)[0].processor_s < before[0].processor_s + 0.02)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  while (work_of(threads)[1].may_run)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const Work after = work_of(threads);
  EXPECT_TRUE(after[0].may_run);
  EXPECT_FALSE(after[1].may_run);
  EXPECT_LT(after[1].processor_s - before[1].processor_s, 0.01);
  stop = true;
  stop.notify_all();
  busy.join();
  idle.join();
}

TEST(Patience, KnowsTheThreadsOfTheDriver) {
  const Device& device = test::test_device();
  if (!is_software(device.description())) GTEST_SKIP() << device.description().name << " computes by itself";
  EXPECT_FALSE(device.driver_threads().empty());
  const std::vector<int> all = threads_of_process();
  EXPECT_TRUE(std::includes(all.begin(), all.end(), device.driver_threads().begin(), device.driver_threads().end()));
}

// Loading the driver takes 0.24 GB: see engine/gpu/software.cpp.
TEST(Software, NeedsWhatWasMeasured) {
  for (const auto& [threads, measured_kb] : {std::pair(1u, 1'099'124), {2u, 1'246'560}, {4u, 1'541'624}}) {
    const auto needs = static_cast<double>(software_device_bytes(threads)) + 0.24e9;
    EXPECT_GT(needs, 1024.0 * measured_kb) << threads;
    EXPECT_LT(needs, 1.2 * 1024.0 * measured_kb) << threads;
  }
}

// A limit that leaves less than the next allocation needs.
TEST(Software, RefusesWhatItsProcessMayNotHave) {
  const DeviceDescription software{.name = "llvmpipe", .kind = "cpu"}, gpu{.name = "card", .kind = "discrete"};
  constexpr std::uint64_t more_than_any = std::uint64_t{1} << 50;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit now = before;
  now.rlim_cur = std::min<rlim_t>(before.rlim_max, std::uint64_t{1} << 46);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &now), 0);
  EXPECT_NO_THROW(require_room_for(gpu, more_than_any));
  EXPECT_ERROR(require_room_for(software, more_than_any), Exit::failed, "ulimit -v");
  const std::string told = test::thrown_by([&] { require_room_for(software, more_than_any); }).what();
  EXPECT_CONTAINS(told, fmt::format("it needs {} MB more, but", (more_than_any + 100'000'000) / 1'000'000));
  const std::string leave = "control group) leave ";
  const double left_mb = std::strtod(told.c_str() + told.find(leave) + leave.size(), nullptr);
  EXPECT_GT(left_mb, 0) << told;
  EXPECT_LE(left_mb, 1e-6 * static_cast<double>(now.rlim_cur)) << told;
  EXPECT_NO_THROW(require_room_for(software, 1 << 20));
  setrlimit(RLIMIT_AS, &before);
}

}  // namespace
}  // namespace palpa::gpu
