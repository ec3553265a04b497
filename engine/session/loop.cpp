#include "session/loop.hpp"

#include <exception>
#include <limits>
#include <optional>
#include <thread>

#include "base/error.hpp"
#include "session/source_clock.hpp"

namespace palpa::session {
namespace {

/// A frame with its times on the loop's clock.
struct Captured {
  sensing::FrameSet set;
  double captured_s = 0;
  double arrived_s = 0;
};

/// A thread whose error is kept for whoever joins it.
class Worker {
 public:
  template <typename Work>
  explicit Worker(Work work) {
    thread_ = std::thread([this, work] {
      try {
        work();
      } catch (...) {
        fault_ = std::current_exception();
      }
    });
  }
  ~Worker() {
    if (thread_.joinable()) thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  std::exception_ptr join() {
    thread_.join();
    return fault_;
  }

 private:
  std::exception_ptr fault_;
  std::thread thread_;
};

/// Raises a flag on every way out of a thread.
struct EndFlag {
  std::atomic<bool>& flag;
  explicit EndFlag(std::atomic<bool>& raised) : flag(raised) {}
  ~EndFlag() { flag = true; }
};

/// Tells the reader that no more frames will come, on every way out of the capture thread.
struct CloseFrames {
  Newest<Captured>& frames;
  explicit CloseFrames(Newest<Captured>& closed) : frames(closed) {}
  ~CloseFrames() { frames.close(); }
};

/// For --every-frame: the value before must be in the reader's hands.
template <typename T>
void wait_until_taken(Newest<T>& values, const std::atomic<bool>& stop) {
  while (!stop && !values.wait_taken(std::chrono::milliseconds(50))) {
  }
}

void capture(sensing::DepthSource& source, Newest<Captured>& frames, Newest<sensing::FrameSet>* recorded,
             const LoopSetting& setting, const Clock& clock, const std::atomic<bool>& stop, LoopStats& stats) {
  SourceClock source_clock;
  while (!stop && (setting.frames == 0 || stats.captured < setting.frames)) {
    Captured& next = frames.back();
    if (!source.next(next.set, setting.output.hold_s)) break;
    if (next.set.frames.empty()) {
      ++stats.missing;
      continue;
    }
    ++stats.captured;
    if (setting.every_frame) wait_until_taken(frames, stop);
    next.arrived_s = clock.now();
    // Frames that wait for the loop have no age of their own.
    next.captured_s = setting.every_frame ? next.arrived_s : source_clock.capture_time(next.set.time_s, next.arrived_s);
    if (recorded) {
      if (setting.every_frame) wait_until_taken(*recorded, stop);
      recorded->back() = next.set;
      if (recorded->publish()) ++stats.unrecorded;
    }
    if (frames.publish()) ++stats.replaced;
  }
}

void record(Newest<sensing::FrameSet>& frames, const LoopObservers& observers) {
  while (!frames.closed()) {
    if (frames.take(std::chrono::milliseconds(100))) observers.record(frames.front());
  }
}

/// Returns the capture time of the last frame planned, on the loop's clock.
double compute(Planner& planner, Newest<Captured>& frames, Newest<Plan>& plans, const Clock& clock,
               std::atomic<bool>& stop, const std::atomic<bool>& output_ended, const LoopSetting& setting,
               const LoopObservers& observers, LoopStats& stats) {
  double begin_s = -1, last_captured_s = -std::numeric_limits<double>::infinity();
  bool alive = false;  // frames are coming
  while (!stop && !output_ended) {
    // With frames under way the device is the one to wait for, else the camera.
    const std::chrono::duration<double> patience(planner.busy() ? 0.0 : 0.05);
    if (planner.can_start() && frames.take(patience)) {
      const Captured& frame = frames.front();
      if (begin_s < 0) begin_s = frame.arrived_s;
      planner.start({.images = frame.set.frames,
                     .sequence = frame.set.sequence,
                     .time_s = frame.set.time_s,
                     .captured_s = frame.captured_s,
                     .arrived_s = frame.arrived_s});
    }
    if (!planner.busy()) {
      if (frames.closed()) break;
      if (alive && !setting.every_frame && clock.now() >= last_captured_s + setting.output.hold_s) {
        alive = false;
        if (observers.expired) observers.expired();
      }
      continue;
    }
    FrameReport report;
    if (!planner.step(plans.back(), report)) continue;
    report.planned_s = clock.now();
    ++stats.planned;
    stats.touching += report.touch->finger_count > 0 ? 1 : 0;
    stats.frame_to_plan_s.add(report.planned_s - report.started_s);
    stats.add_passes(report.passes);
    stats.seconds = report.planned_s - begin_s;
    if (observers.planned) observers.planned(report, plans.back());
    last_captured_s = plans.back().captured_s;
    alive = true;
    plans.publish();
  }
  return last_captured_s;
}

/// Frames that are still under way are not looked at any more; the planner is idle for whoever uses it next.
void drain(Planner& planner, Plan& plan) {
  constexpr int most_steps = 16;  // far more than all frames under way take
  FrameReport report;
  for (int i = 0; i < most_steps && planner.busy(); ++i) {
    try {
      planner.step(plan, report);
    } catch (const Error&) {  // of a frame that nobody waits for
    }
  }
}

}  // namespace

void run_loop(sensing::DepthSource& source, Planner& planner, Link& link, const LoopSetting& setting,
              std::atomic<bool>& stop, const LoopObservers& observers, LoopStats& stats) {
  const Clock clock;
  Newest<Captured> frames;
  Newest<Plan> plans;
  plans.each([&](Plan& plan) { reserve(plan, setting.output.layout.transducers.size()); });
  Newest<sensing::FrameSet> recorded;
  std::atomic<bool> stop_capture{false}, stop_output{false}, output_ended{false}, failed{false};
  std::exception_ptr compute_fault;
  std::optional<Worker> output_thread, recorder_thread, capture_thread;
  try {
    output_thread.emplace([&] {
      const EndFlag ended(output_ended);
      play(link, plans, setting.output, clock, stop_output, failed, stats.output);
    });
    // The link gets silence meanwhile, and the source is not asked before frames can be looked at in time.
    planner.warm_up();
    if (observers.record) {
      recorder_thread.emplace([&] {
        try {
          record(recorded, observers);
        } catch (...) {
          failed = stop = true;  // a recording that cannot go on ends the loop
          throw;
        }
      });
    }
    capture_thread.emplace([&] {
      const CloseFrames close(frames);
      try {
        capture(source, frames, observers.record ? &recorded : nullptr, setting, clock, stop_capture, stats);
      } catch (...) {
        failed = true;
        throw;
      }
    });
    const double last_s = compute(planner, frames, plans, clock, stop, output_ended, setting, observers, stats);
    // A source that ended is one whose frames stopped coming: what it last showed sounds on until it expires.
    while (!stop && !output_ended && !failed && clock.now() < last_s + setting.output.hold_s) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  } catch (...) {
    compute_fault = std::current_exception();
    failed = true;
  }
  // Silence first: the capture thread may be waiting for a camera, the recorder for a disk.
  stop_output = true;
  const std::exception_ptr output_fault = output_thread ? output_thread->join() : nullptr;
  stop_capture = true;
  frames.close();
  const std::exception_ptr capture_fault = capture_thread ? capture_thread->join() : nullptr;
  drain(planner, plans.back());
  recorded.close();
  const std::exception_ptr record_fault = recorder_thread ? recorder_thread->join() : nullptr;
  for (const std::exception_ptr& fault : {compute_fault, output_fault, record_fault, capture_fault}) {
    if (fault) std::rethrow_exception(fault);
  }
}

}  // namespace palpa::session
