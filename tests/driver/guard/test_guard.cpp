// The last bytes on the wire, whatever happens to the loop or the guard.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/system/descriptor.hpp"
#include "base/system/real_time.hpp"
#include "driver/guard/board_link.hpp"
#include "driver/guard/guard.hpp"
#include "driver/rig_parts.hpp"
#include "guard_rig.hpp"
#include "session/links/board_sound.hpp"
#include "support/begins.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/thrown.hpp"
#include "trace_board.hpp"

namespace palpa::driver {
namespace {

using namespace std::chrono_literals;
using test::guard_of_ours;
using test::wait;
using Rig = test::GuardRig;
using Opened = test::Opened<Rig>;

/// What a loop does until it ends: a drive in every slot, a plan now and then.
std::function<void()> plays(Rig& rig, std::chrono::microseconds slot) {
  return [&rig, slot] {
    rig.open();
    for (std::uint64_t s = 0;; ++s, wait(slot)) {
      if (s % 8 == 0) rig.plan(s, 10);
      rig.send(s);
    }
  };
}

TEST(Guard, ABoardGetsTheFociOnlyInTheFreeField) {
  for (const bool free_field : {true, false}) {
    Rig rig;
    rig.setting.free_field = free_field;
    rig.open();
    array::Schedule schedule;
    schedule.add_voice();
    const std::vector<Vec3> foci = {Vec3(0), Vec3(0.25, 0, 0), Vec3(0.5, 0, 0)};
    const array::Drive drives(3 * rig.drive.size());
    for (const std::uint64_t from : {0UL, 1UL}) {
      rig.link->plan({.schedule = schedule,
                      .slots = {from, from + 66, {session::Plays::pattern, 3}},
                      .drives = drives,
                      .foci = from == 0 ? std::span(foci) : std::span<const Vec3>()});
      rig.send(from);
      ASSERT_TRUE(rig.wrote("play " + std::to_string(from)));
    }
    rig.link->finish();
    EXPECT_EQ(rig.count("plan"), 2U);
    EXPECT_EQ(rig.count("foci"), free_field ? 1U : 0U);
    EXPECT_EQ(rig.count("foci 3 0.5"), free_field ? 1U : 0U);
  }
}

TEST(Guard, ABoardIsNotToldOfThePausesOfItsPattern) {
  Opened rig;
  const array::Drive silence(rig.drive.size(), {0, 0});
  rig.plan(0, 10);
  rig.send(0);
  ASSERT_TRUE(rig.wrote("play 0"));
  rig.link->send_planned(1, silence);
  wait(20ms);
  rig.link->send(2, silence);
  ASSERT_TRUE(rig.wrote("play 2"));
  rig.link->send_planned(70, silence);  // the pattern is over
  ASSERT_TRUE(rig.wrote("play 70"));
  EXPECT_EQ(rig.count("play 1 "), 0U);
  rig.end_silent();
}

TEST(Guard, PlaysAndCountsWhatIsSentAndEndsInSilence) {
  Opened rig;
  const auto carried = [&] { return rig.link->carried().value(); };
  EXPECT_EQ(carried().guard->drives, 0u);
  rig.plan(0, 10);
  for (std::uint64_t s = 0; s < 5; ++s) {
    rig.send(s);
    ASSERT_TRUE(rig.wrote("play " + std::to_string(s)));
  }
  // Silence, and what no loop should send: neither sounds.
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::uint64_t s = 8; const array::TransducerDrive& one :
                            std::initializer_list<array::TransducerDrive>{{0, 1}, {1.5f, 1}, {nan, 1}, {1, nan}}) {
    rig.link->send(s, array::Drive(rig.drive.size(), one));
    ASSERT_TRUE(rig.wrote("play " + std::to_string(s++)));
  }
  rig.end_silent();
  std::vector<std::string> all = rig.lines();
  std::erase(all, "off");  // on a busy machine, it may have waited
  EXPECT_EQ(all, (std::vector<std::string>{"open", "plan 0 10", "play 0 0.0625", "play 1 0.125", "play 2 0.1875",
                                           "play 3 0.25", "play 4 0.3125", "play 8 0", "play 9 0", "play 10 0",
                                           "play 11 0", "close"}));
  EXPECT_EQ(guard_of_ours(), -1);
  for (const session::Passed& passed : {*carried().guard, carried().submitted, carried().completed}) {
    EXPECT_EQ(passed.drives, 5u) << "silence is not counted";
    EXPECT_EQ(passed.plans, 1u);
  }
}

TEST(Guard, DrivesThatItDoesNotTakeInTimeAreMissingInItsCounts) {
  Rig rig;
  rig.begin();
  test::stop(guard_of_ours());
  for (std::uint64_t s = 1; s <= 20; ++s)
    rig.send(s);
  kill(guard_of_ours(), SIGCONT);
  ASSERT_TRUE(rig.wrote("play 20"));
  rig.link->finish();
  EXPECT_EQ(rig.link->carried()->guard->drives, 2u) << "the first and the newest";
  EXPECT_EQ(rig.link->carried()->completed.drives, 2u);
}

TEST(Guard, APlanComesBeforeTheDrivesThatBelongToIt) {
  Opened rig;
  for (std::uint64_t s = 0; s < 200; ++s) {
    rig.plan(s, 1);
    rig.send(s);
  }
  rig.link->finish();
  std::string plan;
  for (const std::string& line : rig.lines()) {
    if (line.starts_with("plan")) plan = line.substr(5, line.rfind(' ') - 5);
    if (!line.starts_with("play")) continue;
    EXPECT_GE(std::stoi(plan), std::stoi(line.substr(5))) << "a drive before its plan";
  }
  rig.expect_silent_end();
}

TEST(Guard, WhatTheBoardRefusesIsRefusedAsItSaidIt) {
  const Rig rig;
  EXPECT_EQ(test::error_of([&] { rig.open("refuse"); }), "trace:refuse: there is no such board");
  Rig told;
  told.setting.slot_s = 2e-3;
  told.setting.foci_move = false;
  told.setting.sound_speed_m_s = 350;
  told.setting.ramp_s = 0.02;
  told.setting.steps = false;
  told.setting.nulls = true;
  EXPECT_CONTAINS(test::error_of([&] { told.open("told"); }),
                  "sound at 350 m/s, slots of 0.002 s, a ramp of 0.02 s, foci stand, jumps, nulls");
  EXPECT_CONTAINS(test::error_of([&] { rig.open("told"); }), "foci move, steps, no nulls") << "by default";
  const auto none = board_link({"trace", "", {}, true}, "/nowhere/palpa-guard");
  EXPECT_ERROR(none.open("x", rig.setting), Exit::failed, "/nowhere/palpa-guard");
}

TEST(Guard, ItsNotesAreLogged) {
  Rig rig;
  const std::string said = test::stderr_of([&] {
    rig.open();
    rig.send(7);
    EXPECT_TRUE(rig.wrote("play 7"));
    wait(20ms);
    rig.send(8);
    rig.link->finish();
  });
  EXPECT_CONTAINS(said, "trace: what it has to say");
}

TEST(Guard, WithoutDrivesItSilencesAndPlaysOnWhenTheyReturn) {
  Opened rig;
  const auto begin = std::chrono::steady_clock::now();
  rig.send(0);
  ASSERT_TRUE(rig.wrote("off"));
  const std::chrono::duration<double> after = std::chrono::steady_clock::now() - begin;
  EXPECT_GE(after.count(), 0.1);
  wait(150ms);
  EXPECT_EQ(rig.lines().back(), "off");
  EXPECT_EQ(rig.count("off"), 1u) << "it says so once";
  rig.plan(1, 10);
  rig.send(1);
  ASSERT_TRUE(rig.wrote("play 1"));
  ASSERT_TRUE(rig.ends_with("off")) << "a plan that nobody follows up ends, too";
  rig.send(2);
  ASSERT_TRUE(rig.wrote("play 2"));
  rig.end_silent();
}

TEST(Guard, APlanWithoutADriveIsSilencedToo) {
  Opened rig;
  rig.plan(0, 10);
  ASSERT_TRUE(rig.ends_with("off"));
  EXPECT_EQ(rig.lines(), (std::vector<std::string>{"open", "plan 0 10", "off"}));
  rig.end_silent();
}

TEST(Guard, ALoopThatIsKilledOrCrashesAtAnyInstantLeavesSilence) {
  // On a busy machine, the guard may get no processor for a second. Its loop then ends by itself, and is not killed.
  int killed = 0;
  for (int attempt = 0; killed < 13 && attempt < 30; ++attempt) {
    Rig rig(3984);
    test::ForkedLoop loop(plays(rig, 0us));
    ASSERT_TRUE(test::begins([&] { return loop.ended() || rig.count(killed == 0 ? "open" : "play") > 0; }));
    wait(std::chrono::microseconds(killed * 317));
    if (loop.ended()) continue;
    loop.end(killed == 12 ? SIGABRT : SIGKILL);
    ASSERT_TRUE(rig.wrote("close")) << killed;
    rig.expect_silent_end();
    ++killed;
  }
  EXPECT_EQ(killed, 13);
}

TEST(Guard, ALoopThatIsStoppedIsSilentAndGoesOnWhenItContinues) {
  Rig rig(3984);
  test::ForkedLoop loop(plays(rig, 200us));
  for (int times = 0; times < 3; ++times) {
    ASSERT_TRUE(rig.wrote("play", rig.count("play") + 10));
    loop.signal(SIGSTOP);
    ASSERT_TRUE(rig.ends_with("off"));
    const std::size_t played = rig.count("play");
    loop.signal(SIGCONT);
    ASSERT_TRUE(rig.wrote("play", played + 1));
  }
  loop.signal(SIGSTOP);
  loop.end(SIGKILL);
  ASSERT_TRUE(rig.wrote("close"));
  rig.expect_silent_end();
}

TEST(Guard, AGuardThatIsKilledOrStoppedIsFollowedByOneThatSilences) {
  for (const auto& [signal, what] :
       {std::pair{SIGKILL, "signal 9 ended palpa-guard"}, {SIGSTOP, "palpa-guard took no drive for 1 s"}}) {
    Rig rig;
    rig.open();
    rig.send_for(10ms);
    kill(guard_of_ours(), signal);
    const auto began = std::chrono::steady_clock::now();
    const std::string line = test::error_of([&] { rig.send_for(1min); }, Exit::failed);
    if (signal == SIGSTOP) {
      EXPECT_GE(std::chrono::steady_clock::now() - began, 900ms) << "it had been patient for less";
    }
    EXPECT_EQ(line, std::string("trace: ") + what + ", and a second one was started; " + rig.is_silent());
    EXPECT_EQ(rig.count("open"), 2u);
    rig.expect_silent_end();
    EXPECT_NO_THROW(rig.link->send(rig.slot, rig.drive));  // what SafeLink tries afterwards has no effect
    EXPECT_NO_THROW(rig.link->finish());
  }
}

TEST(Guard, AGuardThatIsStoppedAtTheEndGoesOnAndSilences) {
  Rig rig;
  rig.begin();
  kill(guard_of_ours(), SIGSTOP);
  rig.end_silent();
}

TEST(Guard, ALoopThatWasStoppedTogetherWithItDoesNotEndIt) {
  Opened rig;
  rig.send_for(10ms);
  const pid_t guard = guard_of_ours();
  kill(guard, SIGSTOP);
  rig.send(rig.slot++);
  wait(1200ms);  // equivalent to stopped
  rig.send(rig.slot++);
  kill(guard, SIGCONT);
  rig.send_for(20ms);
  rig.end_silent();
  EXPECT_EQ(rig.count("open"), 1u);
}

TEST(Guard, SlotsLongerThanItsPatienceAreRefused) {
  Rig rig;
  rig.setting.slot_s = 0.2;
  EXPECT_ERROR(rig.open(), Exit::usage, "200 ms is too long: give at most 50 ms");
}

TEST(Guard, AGuardThatDiesWhileItOpensIsFollowedToo) {
  const Rig rig;
  const std::string line =
      test::error_of([&] { static_cast<void>(rig.open("die-once:" + rig.file.string())); }, Exit::failed);
  EXPECT_EQ(line, "trace: signal 9 ended palpa-guard, and a second one was started; the array (trace:die-once:" +
                      rig.file.string() + ") is silent");
  rig.expect_silent_end();
}

TEST(Guard, WhatABoardThrowsEndsInSilence) {
  Opened rig;
  rig.slot = test::throws_from_slot;
  EXPECT_ERROR(rig.send_for(1min), Exit::failed, "a board must not throw");
  EXPECT_TRUE(rig.ends_with("close"));
  EXPECT_GE(rig.count("off"), 1u);
}

TEST(Guard, ADriveOfBeforeAPlanIsNotPlayedAfterIt) {
  Opened rig;
  rig.send_for(20ms);
  test::stop(guard_of_ours());
  rig.send(rig.slot);
  rig.plan(rig.slot + 100, 2);
  kill(guard_of_ours(), SIGCONT);
  ASSERT_TRUE(rig.wrote("plan"));
  wait(20ms);
  EXPECT_EQ(rig.count("play " + std::to_string(rig.slot) + " "), 0u);
  rig.link->finish();
}

TEST(Guard, AGuardThatIsKilledJustBeforeTheEndIsFollowedToo) {
  Opened rig;
  rig.send(0);
  kill(guard_of_ours(), SIGKILL);
  EXPECT_CONTAINS(test::error_of([&] { rig.link->finish(); }, Exit::failed),
                  "and a second one was started; " + rig.is_silent());
  rig.expect_silent_end();
}

TEST(Guard, WhereNobodyCanSilenceTheBoardItSaysSo) {
  Rig rig;
  rig.begin();
  kill(guard_of_ours(), SIGKILL);
  std::filesystem::remove(rig.file);
  std::filesystem::create_directory(rig.file);
  const std::string said = test::stderr_of([&] { EXPECT_ERROR(rig.link->finish(), Exit::failed, "switch it off"); });
  EXPECT_CONTAINS(said, "cannot be opened");
  EXPECT_EQ(session::board_sound("trace:" + rig.file.string()), session::BoardSound::unknown);
}

TEST(Guard, AGuardThatIsToldToLeaveSilencesFirst) {
  for (int instant = 0; instant < 5; ++instant) {
    Rig rig;
    rig.open();
    rig.send_for(10ms);
    kill(guard_of_ours(), SIGTERM);
    const std::string line = test::error_of([&] { rig.send_for(1min); }, Exit::failed);
    EXPECT_CONTAINS(line, "was asked to end");
    EXPECT_EQ(rig.count("open"), 1u);
    rig.expect_silent_end();
  }
}

TEST(Guard, SignalsThatAreForTheLoopDoNotEndIt) {
  Opened rig;
  const pid_t guard = guard_of_ours();
  EXPECT_EQ(getsid(guard), guard);
  rig.send(0);
  for (const int signal : {SIGINT, SIGHUP, SIGPIPE, SIGTSTP, SIGTTIN, SIGTTOU})
    kill(guard, signal);
  ASSERT_TRUE(rig.wrote("play 0"));
  rig.send(1);
  EXPECT_TRUE(rig.wrote("play 1"));
  rig.end_silent();
}

TEST(Guard, ABoardThatMayNotHaveHeardTheLastSilenceIsReported) {
  const Rig rig;
  const std::string argument = "unsure:" + rig.file.string();
  const std::atomic<session::BoardSound>& sound = session::board_sound("trace:" + argument);
  const auto link = rig.open(argument);
  EXPECT_EQ(sound, session::BoardSound::silent);
  link->send(0, rig.drive);
  EXPECT_EQ(sound, session::BoardSound::unknown);
  EXPECT_ERROR(link->finish(), Exit::failed, "has not answered: it may still sound, switch it off");
  EXPECT_EQ(sound, session::BoardSound::told);
  rig.expect_silent_end();
  // Opened again, it is silent, and then out of reach.
  test::write_text(rig.file.string() + "-lost", "");
  const auto again = rig.open(argument);
  EXPECT_EQ(sound, session::BoardSound::silent);
  EXPECT_ERROR(again->finish(), Exit::failed, "is out of reach: it may still sound, switch it off");
  EXPECT_EQ(sound, session::BoardSound::gone);
}

TEST(Guard, ALinkThatIsDroppedLeavesSilence) {
  Opened rig;
  rig.send(0);
  rig.link.reset();
  rig.expect_silent_end();
  EXPECT_EQ(guard_of_ours(), -1);
}

TEST(Guard, ADriveCostsLittleOnBothSides) {
#if defined(PALPA_ADDRESS_SANITIZER) || defined(PALPA_THREAD_SANITIZER)
  GTEST_SKIP() << "skipped: an instrumented build is slow";
#endif
  Rig rig(3984);
  rig.open();
  const pid_t guard = guard_of_ours();
  const auto processor_s = [](pid_t process) {
    std::ifstream in("/proc/" + std::to_string(process) + "/schedstat");
    double ns = 0;
    in >> ns;
    return 1e-9 * ns;
  };
  // The quickest one of three blocks counts: other programs disturb it least.
  constexpr std::uint64_t drives = 100;
  double ours_us = 1e9, its_us = 1e9;
  for (std::uint64_t block = 0; block < 3; ++block) {
    const double ours_s = processor_s(getpid()), its_s = processor_s(guard);
    for (std::uint64_t s = 0; s < drives; ++s, wait(1ms))
      rig.send(block * drives + s);
    ours_us = std::min(ours_us, 1e6 / drives * (processor_s(getpid()) - ours_s));
    its_us = std::min(its_us, 1e6 / drives * (processor_s(guard) - its_s));
  }
  std::printf("a drive of 3984 transducers: %.0f us in the loop, %.0f us in the guard\n", ours_us, its_us);
  EXPECT_LT(ours_us, 200);
  EXPECT_LT(its_us, 200);
  rig.link->finish();
}

TEST(Guard, GoesBeforeOtherProgramsWhereThatIsAllowed) {
  const pid_t asks = fork();  // in a child, which need not be allowed to go back afterwards
  if (asks == 0) {
    const RealTime turns(guard_priority);
    _exit(static_cast<int>(scheduling_of(0)));
  }
  int status = 0;
  waitpid(asks, &status, 0);
  const auto allowed = static_cast<Scheduling>(WEXITSTATUS(status));
  Opened rig;
  EXPECT_EQ(scheduling_of(guard_of_ours()), allowed);
  EXPECT_EQ(rig.link->carried()->guard_scheduling, allowed) << "what a run reports";
}

TEST(Guard, ItsMemoryStaysInMemoryWhereThatIsAllowed) {
  if (mlockall(MCL_CURRENT) != 0) GTEST_SKIP() << "skipped: this machine allows no locked memory (ulimit -l)";
  munlockall();
  if (test::instrumented()) GTEST_SKIP() << "skipped: sanitizers lock no memory";
  Opened rig;
  const std::string status = "/proc/" + std::to_string(guard_of_ours()) + "/status";
  EXPECT_TRUE(test::begins([&] {
    const std::string text = test::read_text(status);
    const std::size_t at = text.find("VmLck:");
    return at != std::string::npos && std::atoi(text.c_str() + at + 6) > 0;
  }));
}

TEST(Guard, InheritsOnlyItsOwnDescriptors) {
  Rig rig;
  const Descriptor open_to_children(open("/dev/null", O_RDONLY));
  rig.open();
  const std::filesystem::directory_iterator descriptors("/proc/" + std::to_string(guard_of_ours()) + "/fd");
  EXPECT_EQ(std::distance(begin(descriptors), end(descriptors)), 6);  // in, out, err; socket, memory; the board's file
}

}  // namespace
}  // namespace palpa::driver
