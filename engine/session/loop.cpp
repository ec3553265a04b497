#include "session/loop.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <thread>

namespace palpa::session {
namespace {

/// A frame with its times on the loop's clock.
struct Captured {
  sensing::FrameSet set;
  double captured_s = 0;
  double arrived_s = 0;
};

/// Maps a source's clock to the loop's: the smallest delay seen so far is taken for none. A frame that dawdled on its
/// way is then as old as it really is, and so is a source that replays faster than time, since no frame is younger than
/// its arrival.
class SourceClock {
 public:
  double capture_time(double source_s, double arrived_s) {
    offset_ = std::min(offset_, arrived_s - source_s);
    return source_s + offset_;
  }

 private:
  double offset_ = std::numeric_limits<double>::infinity();
};

void capture(sensing::DepthSource& source, Newest<Captured>& frames, const LoopSetting& setting, const Clock& clock,
             const std::atomic<bool>& stop, const LoopObservers& observers, LoopStats& stats) {
  SourceClock source_clock;
  while (!stop && (setting.frames == 0 || stats.captured < setting.frames)) {
    Captured& next = frames.back();
    if (!source.next(next.set, setting.output.hold_s)) break;
    if (next.set.frames.empty()) {
      ++stats.missing;
      continue;
    }
    next.arrived_s = clock.now();
    next.captured_s = source_clock.capture_time(next.set.time_s, next.arrived_s);
    ++stats.captured;
    if (observers.captured) observers.captured(next.set);
    if (setting.every_frame) {
      while (!stop && !frames.wait_taken(std::chrono::milliseconds(50))) {
      }
    }
    if (frames.publish()) ++stats.replaced;
  }
}

/// Returns the capture time of the last frame planned, on the loop's clock.
double compute(Chain& chain, Newest<Captured>& frames, Newest<Plan>& plans, const Clock& clock, std::atomic<bool>& stop,
               const std::atomic<bool>& output_ended, const LoopObservers& observers, LoopStats& stats) {
  double begin_s = -1, last_captured_s = -std::numeric_limits<double>::infinity();
  while (!stop && !output_ended) {
    // With frames under way the device is the one to wait for, else the camera.
    const std::chrono::duration<double> patience(chain.busy() ? 0.0 : 0.05);
    if (chain.can_start() && frames.take(patience)) {
      const Captured& frame = frames.front();
      if (begin_s < 0) begin_s = frame.arrived_s;
      chain.start(frame.set, frame.captured_s, frame.arrived_s);
    }
    if (!chain.busy()) {
      if (frames.closed()) break;
      continue;
    }
    FrameReport report;
    if (!chain.step(plans.back(), report)) continue;
    report.planned_s = clock.now();
    ++stats.planned;
    stats.touching += report.touch->finger_count > 0 ? 1 : 0;
    stats.frame_to_plan_s.add(report.planned_s - report.started_s);
    stats.add_passes(report.passes);
    stats.seconds = report.planned_s - begin_s;
    if (observers.planned) observers.planned(report, plans.back());
    last_captured_s = plans.back().captured_s;
    plans.publish();
  }
  return last_captured_s;
}

}  // namespace

void run_loop(sensing::DepthSource& source, Chain& chain, Link& link, const LoopSetting& setting,
              std::atomic<bool>& stop, const LoopObservers& observers, LoopStats& stats) {
  const Clock clock;
  Newest<Captured> frames;
  Newest<Plan> plans;
  plans.each([&](Plan& plan) { reserve(plan, setting.output.layout.transducers.size()); });
  std::atomic<bool> stop_capture{false}, stop_output{false}, output_ended{false};
  std::exception_ptr capture_fault, compute_fault, output_fault;

  std::thread output_thread([&] {
    try {
      play(link, plans, setting.output, clock, stop_output, stats.output);
    } catch (...) {
      output_fault = std::current_exception();
    }
    output_ended = true;
  });
  std::thread capture_thread([&] {
    try {
      capture(source, frames, setting, clock, stop_capture, observers, stats);
    } catch (...) {
      capture_fault = std::current_exception();
    }
    frames.close();
  });
  try {
    const double last_s = compute(chain, frames, plans, clock, stop, output_ended, observers, stats);
    // A source that ended is one whose frames stopped coming: what it last showed sounds on until it expires.
    while (!stop && !output_ended && clock.now() < last_s + setting.output.hold_s) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  } catch (...) {
    compute_fault = std::current_exception();
  }
  // Silence first: the capture thread may be waiting for a camera.
  stop_output = true;
  output_thread.join();
  stop_capture = true;
  frames.close();
  capture_thread.join();
  for (const std::exception_ptr& fault : {compute_fault, output_fault, capture_fault}) {
    if (fault) std::rethrow_exception(fault);
  }
}

}  // namespace palpa::session
