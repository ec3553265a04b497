#include "session/loop/loop.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <exception>
#include <limits>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "session/loop/early_start.hpp"
#include "session/loop/frame_queue.hpp"
#include "session/loop/slow_solver.hpp"
#include "session/loop/source_clock.hpp"
#include "session/predict/capture_times.hpp"
#include "session/predict/slot_clock.hpp"
#include "session/threads.hpp"
#include "session/watch/effort.hpp"

namespace palpa::session {
namespace {

/// A frame with its times on the loop's clock.
struct Captured {
  sensing::FrameSet set;
  double captured_s = 0;
  double arrived_s = 0;
};

/// A thread whose error is kept until it is joined.
class Worker {
 public:
  template <typename Work>
  Worker(const Clock& clock, const char* purpose, Work work) : clock_(clock) {
    thread_ = clock.start(purpose, [this, work] {
      try {
        work();
      } catch (...) {
        fault_ = std::current_exception();
      }
    });
  }
  ~Worker() {
    if (thread_.joinable()) clock_.join(thread_);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  std::exception_ptr join() {
    clock_.join(thread_);
    return fault_;
  }

 private:
  const Clock& clock_;
  std::exception_ptr fault_;
  std::thread thread_;
};

/// Sets a flag however a thread ends.
struct EndFlag {
  std::atomic<bool>& flag;
  explicit EndFlag(std::atomic<bool>& raised) : flag(raised) {}
  ~EndFlag() { flag = true; }
};

/// Tells the reader that no more frames will come, however the capture thread ends.
struct CloseFrames {
  Newest<Captured>& frames;
  explicit CloseFrames(Newest<Captured>& closed) : frames(closed) {}
  ~CloseFrames() { frames.close(); }
};

/// How often a thread that waits for another checks whether to continue.
constexpr std::chrono::milliseconds slice{50};

/// For every_frame: waits until the reader has taken the previous value. False if `stopped()` came first.
template <typename T, typename Stopped>
bool wait_until_taken(Newest<T>& values, Stopped stopped) {
  while (!values.wait_taken(slice)) {
    if (stopped()) return false;
  }
  return true;
}
template <typename Stopped>
void wait_until_empty(FrameQueue& frames, Stopped stopped) {
  while (!frames.wait_empty(slice)) {
    if (stopped()) return;
  }
}

/// The maximum time to wait for a frame before checking for the end again.
constexpr double most_wait_s = 0.1;
/// A user is told that no first frame comes.
constexpr double patience_s = 5;

void capture(sensing::DepthSource& source, Newest<Captured>& frames, FrameQueue* recorded, const LoopSetting& setting,
             const Clock& clock, const std::atomic<bool>& stop, const RunOptions& options, LoopStats& stats) {
  SourceClock source_clock;
  CaptureTimes times;
  const auto stopped = [&] { return stop.load(); };
  const double begin_s = clock.now();
  double looked_s = begin_s;  // time of the last frame, or of the last note that there was none
  bool told = false;
  while (!stop && (options.frames == 0 || stats.captured < options.frames)) {
    Captured& next = frames.back();
    if (!source.next(next.set, std::min(setting.output.hold_s, most_wait_s))) break;
    const double now_s = clock.now();
    if (!next.set.came()) {
      if (stats.captured == 0 && now_s - begin_s > patience_s && !std::exchange(told, true))
        log::at_once(fmt::format("no frame has come from the source for {:g} s; palpa waits", patience_s));
      if (now_s - looked_s < setting.output.hold_s) continue;
      ++stats.missing;
      looked_s = now_s;
      continue;
    }
    looked_s = now_s;
    if (!times.is_time(next.set.time_s)) {
      ++stats.missing;
      continue;
    }
    ++stats.captured;
    if (options.every_frame) wait_until_taken(frames, stopped);
    next.arrived_s = clock.now();
    // Another program pushes points when it knows them, and its times may be those of a simulation.
    next.captured_s = next.set.pushed ? next.arrived_s : source_clock.capture_time(next.set.time_s, next.arrived_s);
    if (options.every_frame) {
      times.see(next.set.time_s);
    } else {
      times.see(next.set.time_s, next.arrived_s, next.arrived_s - next.captured_s);
    }
    if (recorded) {
      if (options.every_frame) wait_until_empty(*recorded, stopped);
      if (recorded->add(next.set)) ++stats.unrecorded;
    }
    options.observer->arrived(next.set.sequence);
    if (frames.publish()) ++stats.replaced;
  }
}

/// After a signal, palpa has one second to end, and a ramp may take half of it.
constexpr double most_recording_after_stop_s = 0.3;

/// Records frames until the queue is over, so also those that wait when the loop ends. If the loop was stopped, records
/// only those for which there is time, and returns the number of the others.
std::uint64_t record(FrameQueue& frames, const std::atomic<bool>& stop, const Clock& clock, const RunOptions& options) {
  sensing::FrameSet set;
  std::optional<double> stopped_s;
  std::uint64_t lost = 0;
  while (!frames.over()) {
    if (!frames.take(set, std::chrono::milliseconds(100))) continue;
    if (stop && !stopped_s) stopped_s = clock.now();
    if (stopped_s && clock.now() > *stopped_s + most_recording_after_stop_s) {
      lost += 1 + frames.discard();
    } else {
      if (frames.closed()) options.observer->recording_rest(frames.waiting() + 1);
      options.record(set);
    }
  }
  return lost;
}

/// Warns once if frames take longer than they sound.
class Overload {
 public:
  Overload(double hold_s, std::string_view too_slow) : hold_s_(hold_s), too_slow_(too_slow) {}

  void planned(double frame_to_drives_s) {
    late_ = frame_to_drives_s < hold_s_ ? 0 : late_ + 1;
    if (late_ < in_a_row || std::exchange(warned_, true)) return;
    if (!too_slow_.empty()) {
      log::warning(too_slow_);
      return;
    }
    const double enough_s = std::ceil(frame_to_drives_s * 30) / 10;
    const std::string longer = enough_s <= longest_s ? fmt::format("--hold {:.0f}ms, or ", enough_s * 1e3) : "";
    log::warning(fmt::format(
        "overloaded: the time from frame to drives is {:.0f} ms, longer than the hold of {:.0f} ms, so a frame "
        "is out of date before it sounds; give {}smaller frames or simpler solids",
        frame_to_drives_s * 1e3, hold_s_ * 1e3, longer));
  }

 private:
  static constexpr int in_a_row = 3;       ///< a single late frame is normal
  static constexpr double longest_s = 10;  ///< the limit of --hold
  double hold_s_;
  std::string_view too_slow_;
  int late_ = 0;
  bool warned_ = false;
};

/// The data and the work of the compute thread.
struct Compute {
  Planner& planner;
  Newest<Captured>& frames;
  Newest<Plan>& plans;
  const Clock& clock;
  const std::atomic<bool>& stop;
  const std::atomic<bool>& output_ended;
  const SlotClock& slots;
  const LoopSetting& setting;
  const RunOptions& options;
  LoopStats& stats;

  /// A frame in progress.
  struct Start {
    double arrived_s = 0;
    bool waited = false;  ///< it came while another was in progress,
    bool early = false;   ///< and was started at once
  };
  std::deque<Start> under_way{};
  EarlyStart early_start{setting.output.hold_s};
  Overload overload{setting.output.hold_s, planner.too_slow()};
  EffortControl effort{setting.output.hold_s, options.every_frame ? Effort{} : planner.most_shed(),
                       setting.lengthens_hold && !options.every_frame ? longest_auto_hold_s : 0};
  ShedReport shed_report{setting.output.hold_s};
  SlowSolver slow_solver{};
  double begin_s = -1;
  double idle_s = -std::numeric_limits<double>::infinity();  ///< time since when no frame is in progress
  double last_captured_s = -std::numeric_limits<double>::infinity();

  /// Returns the capture time of the last frame planned, on the loop's clock.
  double run();

 private:
  bool stopped() const { return stop || output_ended; }
  bool start();
  bool step();
  void shed(const FrameReport& report, double captured_s);
  void watch_solver(const FrameReport& report);
};

/// Starts the newest frame, if there is one and it can be started now.
bool Compute::start() {
  const bool early = planner.busy();
  if (!planner.can_start() || (early && !early_start.now())) return false;
  // With frames in progress, wait for the device, otherwise for the camera.
  if (!frames.take(std::chrono::duration<double>(early ? 0.0 : 0.05))) return false;
  Captured& frame = frames.front();
  under_way.push_back({frame.arrived_s, early || frame.arrived_s < idle_s, early});
  // Frames that wait for the loop have no meaningful age.
  if (options.every_frame) frame.arrived_s = frame.captured_s = clock.now();
  if (begin_s < 0) begin_s = frame.arrived_s;
  const SkinFrame started{.images = frame.set.frames,
                          .capsules = frame.set.capsules,
                          .in_doubt = frame.set.in_doubt,
                          .points = frame.set.points,
                          .sequence = frame.set.sequence,
                          .time_s = frame.set.time_s,
                          .captured_s = frame.captured_s,
                          .arrived_s = frame.arrived_s,
                          .slots = options.every_frame ? nullptr : &slots};
  planner.start(started);
  options.observer->started(started);
  return true;
}

/// Advances the oldest frame. Returns whether another plan is complete.
bool Compute::step() {
  if (options.every_frame && !wait_until_taken(plans, [&] { return stopped(); })) return false;
  FrameReport report;
  if (!planner.step(plans.back(), report)) return false;
  report.planned_s = clock.now();
  const Start started = under_way.front();
  under_way.pop_front();
  if (!planner.busy()) idle_s = report.planned_s;
  if (started.waited) early_start.took(report.planned_s - started.arrived_s, started.early);
  ++stats.planned;
  stats.touching += report.touch->finger_count > 0 ? 1 : 0;
  if (stats.dropped) *stats.dropped += report.touch->dropped;
  stats.frame_to_plan_s.add(report.planned_s - report.arrived_s);
  stats.add_passes(report.passes);
  if (report.prediction) {
    if (!stats.prediction) stats.prediction.emplace();
    stats.prediction->add(report.prediction->latency_s, report.prediction->distance_m, report.prediction->clamped);
  }
  stats.seconds = report.planned_s - begin_s;
  report.effort = effort.now();
  report.outdated = !options.every_frame && report.planned_s - plans.back().captured_s >= effort.hold_s();
  shed(report, plans.back().captured_s);
  options.observer->planned(report, plans.back());
  watch_solver(report);
  last_captured_s = plans.back().captured_s;
  if (effort.exhausted()) overload.planned(report.planned_s - last_captured_s);
  if (plans.publish()) ++stats.unplayed;
  return true;
}

/// Warns once if the solver `loudest` cannot keep up with the frames.
void Compute::watch_solver(const FrameReport& report) {
  if (setting.output.drive.solver != array::Solver::loudest || options.every_frame) return;
  if (report.touch->finger_count == 0) return slow_solver.idle();
  if (!slow_solver.planned(report.sequence)) return;
  log::warning(
      fmt::format("the solver loudest is slower than the frames come: a frame takes {:.0f} ms, and others are left out "
                  "meanwhile; for foci that follow every frame, take --solver gs-pat",
                  (report.planned_s - report.arrived_s) * 1e3));
}

/// If frames are late, part of the work is left out from the next frame on.
void Compute::shed(const FrameReport& report, double captured_s) {
  const FrameTimes times{report.planned_s - captured_s, report.planned_s - report.arrived_s,
                         captured_s - last_captured_s};
  if (effort.planned(times)) planner.set_effort(effort.now());
  shed_report.planned(effort);
  if (effort.acted()) stats.shed = {effort.least(), effort.most_hold_s(), effort.shed_frames()};
  plans.back().more_hold_s = effort.hold_s() - setting.output.hold_s;
}

double Compute::run() {
  bool alive = false;      // frames are coming
  planner.set_effort({});  // reset the effort of an earlier run
  while (!stopped()) {
    start();
    if (planner.busy()) {
      alive = step() || alive;
      continue;
    }
    if (frames.closed()) break;
    if (alive && !options.every_frame && clock.now() >= last_captured_s + effort.hold_s()) {
      alive = false;
      options.observer->expired();
    }
  }
  shed_report.end(effort);
  planner.set_effort({});  // for the next user
  return last_captured_s;
}

/// Discards the frames in progress, so that the planner is idle for its next user.
void drain(Planner& planner, Plan& plan) {
  constexpr int most_steps = 16;  // far more than all frames in progress take
  FrameReport report;
  for (int i = 0; i < most_steps && planner.busy(); ++i) {
    try {
      planner.step(plan, report);
    } catch (...) {  // error of a frame that nobody needs
    }
  }
}

}  // namespace

void run_loop(sensing::DepthSource& source, Planner& planner, Link& link, const LoopSetting& setting,
              std::atomic<bool>& stop, const RunOptions& options, LoopStats& stats, const Clock& clock) {
  const log::Relay relay;  // log messages of any thread do not block any thread
  SlotClock slots(clock, setting.output.slot_s);
  OutputSetting output = setting.output;
  output.slots = &slots;
  Newest<Captured> frames(clock);
  Newest<Plan> plans(clock);
  plans.each([&](Plan& plan) { reserve(plan, setting.output.layout.transducers.size()); });
  FrameQueue recorded(options.record_waiting_bytes, clock);
  std::uint64_t lost = 0;  // frames that waited for the recorder at the end; its thread's
  Ending ending{stop};
  std::atomic<bool> stop_capture{false}, output_ended{false};
  std::exception_ptr compute_fault;
  std::optional<Worker> output_thread, recorder_thread, capture_thread;
  try {
    // Any error ends the loop and every wait within it.
    const auto fail = [&] {
      ending.failed = true;
      stop = true;
    };
    output_thread.emplace(clock, "the link", [&, fail] {
      const EndFlag ended(output_ended);
      go_first();  // drives leave on time
      try {
        play(link, plans, output, clock, ending, stats.output, *options.observer);
      } catch (...) {
        fail();
        throw;
      }
    });
    // Meanwhile, the link gets silence. The source is read only when frames can be processed in time.
    planner.warm_up();
    if (options.record) {
      recorder_thread.emplace(clock, "--record", [&, fail] {
        take_turns();  // the calling thread may have precedence
        try {
          lost = record(recorded, stop, clock, options);
        } catch (...) {
          fail();  // a recording that cannot go on ends the loop
          throw;
        }
      });
    }
    capture_thread.emplace(clock, "the source", [&, fail] {
      const CloseFrames close(frames);
      take_turns();  // a source that renders or unpacks frames works as long as the touch that waits for them
      try {
        capture(source, frames, options.record ? &recorded : nullptr, setting, clock, stop_capture, options, stats);
      } catch (...) {
        fail();
        throw;
      }
    });
    Compute compute{planner, frames, plans, clock, stop, output_ended, slots, setting, options, stats};
    const double last_s = compute.run();
    // If the source has ended, its last frame is played until it expires, as if frames had stopped coming.
    const auto sounds_on = [&] { return clock.now() < last_s + compute.effort.hold_s() || !plans.wait_taken({}); };
    while (!stop && !output_ended && !ending.failed && sounds_on()) {
      clock.sleep_until(clock.now() + 2e-3);
    }
  } catch (...) {
    compute_fault = std::current_exception();
    ending.failed = true;
    stop = true;
  }
  // Silence first: the capture thread may be waiting for a camera, the recorder for a disk.
  ending.over = true;
  const std::exception_ptr output_fault = output_thread ? output_thread->join() : nullptr;
  stop_capture = true;
  frames.close();
  const std::exception_ptr capture_fault = capture_thread ? capture_thread->join() : nullptr;
  recorded.close();
  drain(planner, plans.back());
  const std::exception_ptr record_fault = recorder_thread ? recorder_thread->join() : nullptr;
  stats.unrecorded += lost;
  for (const std::exception_ptr& fault : {compute_fault, output_fault, record_fault, capture_fault}) {
    if (fault) std::rethrow_exception(fault);
  }
}

}  // namespace palpa::session
