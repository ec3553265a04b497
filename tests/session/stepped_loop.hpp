// A loop whose frames, plans, link and time are the test's.
#pragma once

#include <atomic>

#include "fakes.hpp"
#include "session/loop/loop.hpp"
#include "stepped_clock.hpp"
#include "support/thrown.hpp"

namespace palpa::test {

template <typename Planner = FakePlanner>
struct SteppedLoop {
  SteppedClock clock;
  FakeSource source;
  Planner planner;
  SpyLink link;
  session::LoopSetting setting{{planner.layout, {}, 1.5e-3, 0.1}};
  std::atomic<bool> stop{false};
  session::LoopStats stats;
  Watcher watcher;
  session::RunOptions options{.observer = &watcher};

  SteppedLoop() { source.clock = &clock; }
  void run() { run_with(link); }
  void run_with(session::Link& other) {
    session::run_loop(source, planner, other, setting, stop, options, stats, clock);
  }
  void stop_at(double time_s) {
    watcher.on_sent = [this, time_s](bool, const session::HandOver&) {
      if (clock.now() >= time_s) stop = true;
    };
  }
  /// The error with which it ends; empty if there is none.
  std::string fault() {
    return thrown_by([this] { run(); }).what();
  }
};

}  // namespace palpa::test
