#include "session/session.hpp"

#include <fmt/core.h>

#include <exception>
#include <optional>
#include <span>
#include <utility>

#include "base/error.hpp"
#include "session/loop/live_fingers.hpp"
#include "session/loop/loop.hpp"
#include "session/plan/tuning_thread.hpp"
#include "session/watch/pressure_log.hpp"

namespace palpa::session {

namespace {

/// Refuses times with which the session would never be silent or never end, when the session is made.
void check_times(const SessionSetting& setting) {
  if (!(setting.hold_s > 0)) throw bad_usage(fmt::format("a hold of {} s: give a positive time", setting.hold_s));
  const double dwell_s = setting.schedule.voice.dwell_s;
  if (!(dwell_s > 0 && dwell_s <= 10)) throw bad_usage(fmt::format("a dwell of {} s: give 0 to 10 s", dwell_s));
  check_safety(setting.safety);
  const double latency_s = setting.predict.latency_s.value_or(0);
  if (!(latency_s >= 0 && latency_s <= most_ahead_s)) {
    throw bad_usage(fmt::format("a latency of {} s to predict: give 0 to {} s", latency_s, most_ahead_s));
  }
}

/// Empty without an array, and if a spot or another field replaces it.
std::optional<acoustics::ArrayField> field_of(const SessionSetting& setting) {
  if (setting.field || setting.layout.transducers.empty() || setting.schedule.spot_m) return std::nullopt;
  return std::optional<acoustics::ArrayField>(std::in_place, setting.layout, setting.drive);
}

/// Tunes strides beside the loop while this object exists.
struct TunedBeside {
  Scheduler& scheduler;
  TunedBeside(Scheduler& tuned, const acoustics::ArrayField* field) : scheduler(tuned) { scheduler.tune_beside(field); }
  ~TunedBeside() { scheduler.tune_beside(nullptr); }
  TunedBeside(const TunedBeside&) = delete;
  TunedBeside& operator=(const TunedBeside&) = delete;
};

/// Passes a run on to the caller's observer, with what a session adds to it.
class SessionObserver final : public RunObserver {
 public:
  /// `fingers` and `tracker`: nullptr without them.
  SessionObserver(std::span<const std::string> solids, LiveFingers* fingers, EventTracker* tracker,
                  const RunOptions& options)
      : pressures_(solids), fingers_(fingers), tracker_(tracker), sink_(options.events), caller_(*options.observer) {}

  void arrived(std::uint64_t sequence) override { caller_.arrived(sequence); }
  void started(const SkinFrame& frame) override {
    if (fingers_) fingers_->saw(frame.images, frame.sequence);
    caller_.started(frame);
  }
  void planned(const FrameReport& report, const Plan& plan) override {
    pressures_.planned(plan.schedule);
    if (fingers_) fingers_->planned(report, plan.schedule);
    caller_.planned(report, plan);
    if (tracker_) tell(tracker_->update(*report.touch, report.time_s));
  }
  void expired() override {
    caller_.expired();
    if (tracker_) tell(tracker_->expire());
  }
  void sent(bool sounds, const HandOver& counts) override { caller_.sent(sounds, counts); }
  void recording_rest(std::uint64_t frames) override { caller_.recording_rest(frames); }

  /// The run is over.
  void end() {
    if (tracker_) tell(tracker_->end());
  }
  const PressureLog& pressures() const { return pressures_; }

 private:
  void tell(std::span<const Event> events) {
    if (sink_) sink_->write(events);
    caller_.events(events);
  }

  PressureLog pressures_;
  LiveFingers* fingers_;
  EventTracker* tracker_;
  EventSink* sink_;
  RunObserver& caller_;
};

}  // namespace

struct Session::State {
  SessionSetting setting;
  std::vector<std::string> names;
  std::optional<acoustics::ArrayField> field;
  Scheduler scheduler;
  EventTracker tracker;
  std::unique_ptr<LiveFingers> fingers;  ///< if the setting has a finger
  std::unique_ptr<Planner> planner;

  // Frame by frame.
  std::vector<sensing::SkinPoint> skin;
  Plan plan;
  FrameReport report;
  std::span<const Event> events;

  State(const gpu::Device* device, SessionSetting given)
      : setting((check_times(given), std::move(given))),
        field(field_of(setting)),
        scheduler(setting.scene, setting.solids, setting.touch, setting.schedule, felt_by()),
        tracker(setting.solids, setting.events.value_or(EventOptions()), setting.hold_s) {
    names.reserve(setting.solids.size());
    for (const geometry::Solid& solid : setting.solids)
      names.push_back(solid.name);
    if (scheduler.needs_pressures() && setting.drive.solver == array::Solver::greedy)
      throw bad_usage(
          "the solver greedy drives all transducers in full: it cannot give a pressure; use gs-pat or naive");
    if (setting.drive.nulls && (scheduler.needs_pressures() || setting.finger || setting.own_solver)) {
      throw bad_usage(
          "nulls are places in free air: solids and options may not ask for a pressure, a finger's transfer or a "
          "solver of one's own");
    }
    if (setting.own_solver && (scheduler.needs_pressures() || setting.finger)) {
      throw bad_usage(
          "a solver of one's own works in free air, and does not reach pressures: solids and options may not ask for "
          "a pressure or a finger's transfer");
    }
    if (setting.finger && !setting.live())
      throw bad_usage("a session computes foci on fingers only while it runs, from the images of depth cameras");
    if (setting.finger) fingers = std::make_unique<LiveFingers>(setting);
    planner = make_planner(device, setting, scheduler, fingers.get());
  }

  const acoustics::FocusField* felt_by() const { return setting.field ? setting.field : field ? &*field : nullptr; }

  const touch::Touch& touch(const SkinFrame& frame) {
    planner->start(frame);
    while (!planner->step(plan, report)) {
    }
    if (setting.events) events = tracker.update(*report.touch, frame.time_s);
    return *report.touch;
  }
};

Session::Session(SessionSetting setting) : state_(std::make_unique<State>(nullptr, std::move(setting))) {}
Session::Session(const gpu::Device& device, SessionSetting setting)
    : state_(std::make_unique<State>(&device, std::move(setting))) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

const SessionSetting& Session::setting() const {
  return state_->setting;
}
const std::vector<std::string>& Session::solid_names() const {
  return state_->names;
}
LinkSetting Session::link_setting() const {
  const touch::Method method = state_->setting.schedule.method.method;
  const bool still = method == touch::Method::single_focus || method == touch::Method::multi_focus;
  const SessionSetting& setting = state_->setting;
  return {.layout = setting.layout,
          .solid_names = state_->names,
          .slot_s = state_->scheduler.slot_s(),
          .foci_move = !still,
          .sound_speed_m_s = setting.drive.medium.sound_speed,
          .ramp_s = setting.safety.ramp_s,
          // Boards compute phases for their own frequency.
          .free_field = !setting.finger && !setting.own_solver && !setting.drive.nulls &&
                        setting.drive.transfer == nullptr &&
                        setting.drive.medium.frequency == setting.layout.frequency_hz,
          .nulls = setting.drive.nulls != nullptr};
}

void Session::warm_up() {
  state_->planner->warm_up();
}

LoopStats Session::run(sensing::DepthSource& source, Link& link, std::atomic<bool>& stop, const RunOptions& options) {
  State& s = *state_;
  if (!s.setting.live())
    throw bad_usage("a session without cameras or without an array, or one of single frames, cannot run");
  if (s.setting.schedule.tune == Tune::all) {
    throw bad_usage("a session that runs can tune strides only: the length of its slots is fixed");
  }
  if (s.fingers && options.every_frame) {
    throw bad_usage("foci on fingers follow the clock, not the frames: a run of every frame cannot have them");
  }
  if (options.events && !s.setting.events) throw bad_usage("a session whose setting has no events cannot report any");
  SessionObserver observer(s.names, s.fingers.get(), s.setting.events ? &s.tracker : nullptr, options);
  RunOptions loop = options;
  loop.observer = &observer;
  if (s.fingers) s.fingers->begin();
  LoopStats stats;
  if (drops_points(s.setting)) stats.dropped.emplace();
  s.planner->list_standing(link.plays_plans());
  // The moment at which the field is known depends on the machine. So it is not used if every frame must have the same
  // result on all machines.
  const TunedBeside beside(s.scheduler, options.every_frame || !s.field ? nullptr : &*s.field);
  try {
    run_loop(source, *s.planner, link,
             {.output = {s.setting.layout, s.setting.drive, s.scheduler.slot_s(), s.setting.hold_s, s.setting.safety},
              .lengthens_hold = s.setting.lengthens_hold},
             stop, loop, stats);
  } catch (...) {
    const std::exception_ptr fault = std::current_exception();
    try {
      observer.end();
    } catch (const std::exception&) {  // the first error is the one to report
    }
    std::rethrow_exception(fault);
  }
  observer.end();
  if (s.setting.schedule.tune == Tune::stride) {
    const TuningThread* const tuning = s.scheduler.tuning();
    stats.tune = {tuning != nullptr, tuning ? tuning->known() : 0};
  }
  if (s.fingers) stats.finger_sounds = s.fingers->stats();
  stats.fingers = observer.pressures().fingers();
  stats.solids = s.names;
  return stats;
}

const touch::Touch& Session::touch(std::span<const glm::vec3> skin, double time_s,
                                   std::optional<std::uint64_t> first_slot) {
  std::vector<sensing::SkinPoint>& points = state_->skin;
  points.resize(skin.size());
  for (std::size_t i = 0; i < skin.size(); ++i)
    points[i] = {skin[i], static_cast<std::uint32_t>(i)};
  return touch(points, time_s, first_slot);
}

const touch::Touch& Session::touch(std::span<const sensing::SkinPoint> skin, double time_s,
                                   std::optional<std::uint64_t> first_slot) {
  if (!state_->setting.cameras.empty()) throw bad_usage("a session with cameras takes depth frames, not skin points");
  return state_->touch({.points = skin, .time_s = time_s, .captured_s = time_s, .first_slot = first_slot});
}

const touch::Touch& Session::touch(std::span<const sensing::DepthFrame> images, double time_s) {
  if (state_->setting.cameras.empty()) throw bad_usage("a session without cameras takes skin points, not depth frames");
  return state_->touch({.images = images, .time_s = time_s, .captured_s = time_s});
}

const touch::Touch& Session::touch(std::span<const sensing::DepthFrame> images, double time_s,
                                   std::uint64_t first_slot) {
  if (state_->setting.cameras.empty()) throw bad_usage("a session without cameras takes skin points, not depth frames");
  return state_->touch({.images = images, .time_s = time_s, .captured_s = time_s, .first_slot = first_slot});
}

std::span<const Event> Session::events() const {
  return state_->events;
}
const Plan& Session::plan() const {
  return state_->plan;
}
const Scheduler& Session::scheduler() const {
  return state_->scheduler;
}
const acoustics::FocusField* Session::field() const {
  return state_->felt_by();
}
const FrameReport& Session::report() const {
  return state_->report;
}

void Session::set_pose(std::uint32_t solid, const Transform& T_world_rest) {
  state_->planner->set_pose(solid, T_world_rest);
}

void Session::set_aim(const Vec3& offset) {
  state_->scheduler.aim(offset);
}

std::span<const Event> Session::expire() {
  return state_->events = state_->tracker.expire();
}

std::span<const Event> Session::end() {
  return state_->events = state_->tracker.end();
}

}  // namespace palpa::session
