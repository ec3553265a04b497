// A source, a planner, a link and an observer that the test controls.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "base/error.hpp"
#include "geometry/solid.hpp"
#include "sensing/depth_source.hpp"
#include "session/clock.hpp"
#include "session/links/link.hpp"
#include "session/loop/run_observer.hpp"
#include "session/plan/planner.hpp"
#include "session/watch/event_sink.hpp"

namespace palpa::test {

array::Layout small_layout();
/// "solid 0" and so on, which feel like this.
std::vector<geometry::Solid> solids_with(const std::vector<geometry::Haptics>& haptics);
/// Lists the drives of a plan's schedule, as planners do.
void list_drives(const array::Layout& layout, session::Plan& plan);
/// One finger, ten foci on a circle about `centre`.
array::Schedule touching(const Vec3& centre, double modulation_hz = 0);

struct FakeSource : sensing::DepthSource {
  std::vector<sensing::Camera> rig{sensing::Camera{.name = "fake", .width = 2, .height = 2, .fx = 1, .fy = 1}};
  const session::Clock* clock = &session::real_clock();
  std::uint64_t count = 10;  ///< frames until the end
  double period_s = 0.002;
  double clock_rate = 1;                      ///< seconds on the source's clock per second of time
  std::uint64_t reset_at = ~0ull;             ///< at this frame, the source's clock restarts, far back
  std::function<void(std::uint64_t)> before;  ///< called before frame n; may sleep or throw
  std::uint64_t given = 0;
  double begin_s = 0;

  const std::vector<sensing::Camera>& cameras() const override { return rig; }
  bool next(sensing::FrameSet& out, double timeout_s) override;
};

/// Every frame touches (or not, as `fingers` says); plans are made at once.
struct FakePlanner : session::Planner {
  array::Layout layout = small_layout();
  std::function<std::uint32_t(std::uint64_t)> fingers = [](std::uint64_t) { return 1u; };
  std::function<void(std::uint64_t)> before;  ///< called in step; may sleep or throw
  std::vector<std::uint64_t> seen;
  bool under_way = false;
  session::FrameReport current;
  double captured_s = 0;
  touch::Touch touch;

  bool can_start() const override { return !under_way; }
  bool busy() const override { return under_way; }
  void start(const session::SkinFrame& frame) override;
  bool step(session::Plan& plan, session::FrameReport& report) override;
  void set_pose(std::uint32_t, const Transform&) override {}
};

/// The largest amplitude of a drive, or of several.
float loudest_of(std::span<const array::TransducerDrive> drive);

/// Remembers the plans and drives that it got.
struct SpyLink : session::Link {
  std::vector<std::uint64_t> slots;
  std::vector<float> loudest;  ///< largest amplitude of each drive
  /// For a plan that it got: the first voice's gain, and the loudest of the listed drives.
  struct Played {
    std::uint32_t voices;
    session::Slots slots;
    double gain;
    float loudest;
    const void* schedule;
    const void* drives;
  };
  std::vector<Played> plans;
  std::vector<const void*> sent;  ///< the address of each drive
  std::atomic<float> most{0};     ///< the loudest so far, for other threads
  bool finished = false;
  std::uint64_t fail_at = ~0ull;  ///< throws in the n-th send, and in every later one while `broken`
  bool broken = false;

  void plan(const session::PlayedPlan& plan) override;
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override;
  void finish() override { finished = true; }
  bool ended_silent() const { return !loudest.empty() && loudest.back() == 0.0f; }
};

struct DeafSink final : session::EventSink {
  void write(std::span<const session::Event>) override {}
};

/// An observer made of functions; one that is missing is not called.
struct Watcher final : session::RunObserver {
  std::function<void(std::uint64_t sequence)> on_arrived;
  std::function<void(const session::FrameReport&, const session::Plan&)> on_planned;
  std::function<void()> on_expired;
  std::function<void(bool sounds, const session::HandOver&)> on_sent;
  std::function<void(std::uint64_t frames)> on_recording_rest;
  std::function<void(std::span<const session::Event>)> on_events;

  void arrived(std::uint64_t sequence) override {
    if (on_arrived) on_arrived(sequence);
  }
  void planned(const session::FrameReport& report, const session::Plan& plan) override {
    if (on_planned) on_planned(report, plan);
  }
  void expired() override {
    if (on_expired) on_expired();
  }
  void sent(bool sounds, const session::HandOver& counts) override {
    if (on_sent) on_sent(sounds, counts);
  }
  void recording_rest(std::uint64_t frames) override {
    if (on_recording_rest) on_recording_rest(frames);
  }
  void events(std::span<const session::Event> events) override {
    if (on_events) on_events(events);
  }
};

}  // namespace palpa::test
