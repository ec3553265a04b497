#include "session/points_run.hpp"

#include <exception>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "session/loop/output.hpp"
#include "session/newest.hpp"
#include "session/plan/plan.hpp"
#include "session/predict/slot_clock.hpp"
#include "session/threads.hpp"

namespace palpa::session {
namespace {

/// How often the computing thread looks whether it is to end.
constexpr double between_looks_s = 0.02;

void check_points_session(const SessionSetting& setting, const RunOptions& options) {
  if (!setting.cameras.empty() || setting.layout.transducers.empty())
    throw bad_usage("a session with cameras or without an array cannot run from points");
  check_run(setting, options.events != nullptr, "runs");
}

}  // namespace

bool PushedPoints::push(std::vector<glm::vec3> points, double time_s) {
  bool replaced = false;
  {
    const std::lock_guard lock(mutex_);
    points_ = std::move(points);
    time_s_ = time_s;
    replaced = std::exchange(fresh_, true);
  }
  clock_.wake(came_);
  return replaced;
}

bool PushedPoints::take(std::vector<glm::vec3>& points, double& time_s, double timeout_s) {
  std::unique_lock lock(mutex_);
  if (!clock_.wait(came_, lock, timeout_s, [this] { return fresh_; })) return false;
  std::swap(points, points_);
  time_s = time_s_;
  fresh_ = false;
  return true;
}

LoopStats run_points(Session& session, PushedPoints& source, Link& link, std::atomic<bool>& stop,
                     const RunOptions& options, const Clock& clock) {
  const log::Relay relay;  // log messages of any thread do not block any thread
  const SessionSetting& setting = session.setting();
  RunObserver& observer = *options.observer;
  check_points_session(setting, options);
  const auto tell = [&](std::span<const Event> events) {
    if (options.events) options.events->write(events);
    observer.events(events);
  };
  session.warm_up();
  LoopStats stats;
  stats.solids = session.solid_names();
  const double begin_s = clock.now();
  Newest<Plan> plans(clock);
  plans.each([&](Plan& plan) { reserve(plan, setting.layout.transducers.size()); });
  Ending ending{stop};
  SlotClock slots(clock, session.scheduler().slot_s());
  const OutputSetting output{setting.layout, setting.drive,  session.scheduler().slot_s(),
                             setting.hold_s, setting.safety, &slots};
  std::exception_ptr link_fault, fault;
  std::atomic<bool> output_over{false};
  std::thread player = clock.start("the link", [&] {
    go_first();  // drives leave on time
    try {
      play(link, plans, output, clock, ending, stats.output, observer);
    } catch (...) {
      link_fault = std::current_exception();
      stop = true;
    }
    output_over = true;
  });
  try {
    std::vector<glm::vec3> points;
    double time_s = 0, last_captured_s = 0;
    bool alive = false;  // frames are coming
    while (!stop && !output_over && (options.frames == 0 || stats.captured < options.frames)) {
      if (!source.take(points, time_s, between_looks_s)) {
        if (alive && clock.now() >= last_captured_s + setting.hold_s) {
          alive = false;
          observer.expired();
          if (setting.events) tell(session.expire());
        }
        continue;
      }
      const double captured_s = clock.now();
      last_captured_s = captured_s;
      alive = true;
      ++stats.captured;
      if (options.changes) options.changes->before_frame(session);
      const std::optional<FirstSlot> first = slots.first(captured_s);
      const touch::Touch& touch = session.touch(points, time_s, first ? std::optional(first->slot) : std::nullopt);
      Plan& plan = plans.back();
      plan = session.plan();
      plan.captured_s = captured_s;
      FrameReport report = session.report();
      report.sequence = stats.planned++;
      report.time_s = time_s;
      report.touch = &touch;
      report.arrived_s = captured_s;
      report.planned_s = clock.now();
      stats.touching += touch.finger_count > 0 ? 1 : 0;
      stats.frame_to_plan_s.add(report.planned_s - captured_s);
      stats.add_passes(report.passes);
      stats.seconds = report.planned_s - begin_s;
      observer.planned(report, plan);
      if (plans.publish()) ++stats.unplayed;
      if (setting.events) tell(session.events());
    }
  } catch (...) {
    fault = std::current_exception();
    ending.failed = true;
  }
  ending.over = true;
  clock.join(player);
  const std::exception_ptr first = link_fault ? link_fault : fault;
  if (first) stop = true;
  try {
    if (setting.events) tell(session.end());
  } catch (const std::exception&) {
    if (!first) throw;  // the first error is the one to report
  }
  if (first) std::rethrow_exception(first);
  return stats;
}

}  // namespace palpa::session
