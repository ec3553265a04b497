#include "session/session.hpp"

#include <fmt/core.h>

#include <exception>
#include <optional>
#include <span>
#include <utility>

#include "base/error.hpp"
#include "session/loop/live_fingers.hpp"
#include "session/loop/loop.hpp"
#include "session/plan/played_parts.hpp"
#include "session/plan/tuning_thread.hpp"
#include "session/previews/ear_sound.hpp"
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
        scheduler(setting.scene, setting.solids, setting.touch, setting.schedule, felt_by(), setting.hold_s),
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
    if (setting.finger && (!setting.live() || setting.cameras.empty()))
      throw bad_usage("a session computes foci on fingers only while it runs, from the images of depth cameras");
    if (setting.finger) fingers = std::make_unique<LiveFingers>(setting);
    planner = make_planner(device, setting, scheduler, fingers.get());
  }

  const acoustics::FocusField* felt_by() const { return setting.field ? setting.field : field ? &*field : nullptr; }

  const touch::Touch& touch(const SkinFrame& frame) {
    planner->start(frame);
    while (!planner->step(plan, report)) {
    }
    if (setting.events) events = tracker.update(*report.touch, frame.time_s, report.hands);
    return *report.touch;
  }
};

/// Grows with how loud a schedule is to the ear: with the ways from focus to focus and with the powers.
double noise_of(const array::Schedule& schedule) {
  constexpr double still_m = 1e-3;  // a modulation also makes noise
  double noise = 0;
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const array::Voice& voice = schedule.voices[v];
    double way = 0;
    for (std::size_t i = voice.foci_per_slot; i < voice.order.size(); ++i)
      way += glm::distance(voice.foci[voice.order[i]], voice.foci[voice.order[i - 1]]);
    noise += voice.gain * voice.gain * (still_m + way);
  }
  return noise;
}

/// Passes a run on to the caller's observer, with what a session adds to it.
class Session::Observer final : public RunObserver {
 public:
  Observer(const RunOptions& options, std::size_t transducers) : sink_(options.events), caller_(*options.observer) {
    reserve(loud_plan_, transducers);
  }
  /// The plan that is probably the loudest to the ear; without voices if nothing was touched.
  const Plan& loudest() const { return loud_plan_; }

  /// Frames are of this scene from now on. `fingers` and `tracker`: nullptr without them.
  void begin(std::span<const std::string> solids, LiveFingers* fingers, EventTracker* tracker) {
    if (sink_ && log_) sink_->name_solids(solids);
    solids_ = solids;
    log_.emplace(solids);
    fingers_ = fingers;
    tracker_ = tracker;
  }
  /// The scene or the run is over: fingers that still touch are released.
  void end() {
    for (FingerPressure finger : log_->fingers()) {
      finger.solid += static_cast<std::uint32_t>(names_.size());
      pressures_.push_back(finger);
    }
    names_.insert(names_.end(), solids_.begin(), solids_.end());
    if (tracker_) tell(tracker_->end());
  }

  /// Drives are played by these boards. Null: by no boards.
  void play_on(const SessionSetting& setting, const array::Layout* boards) {
    if (boards) played_.emplace(*boards, setting.drive, setting.safety);
  }

  void arrived(std::uint64_t sequence) override { caller_.arrived(sequence); }
  void started(const SkinFrame& frame) override {
    if (fingers_) fingers_->saw(frame.images, frame.sequence);
    caller_.started(frame);
  }
  void planned(const FrameReport& report, const Plan& plan) override {
    if (const double noise = noise_of(plan.schedule); noise > loudest_) {
      loudest_ = noise;
      loud_plan_ = plan;
    }
    if (played_ && array::Loudness::asked(plan.schedule)) {
      log_->planned(plan.schedule, &played_->correct(plan));
    } else {
      log_->planned(plan.schedule);
    }
    if (fingers_) fingers_->planned(report, plan.schedule);
    caller_.planned(report, plan);
    if (tracker_) tell(tracker_->update(*report.touch, report.time_s, report.hands));
  }
  void expired() override {
    caller_.expired();
    if (tracker_) tell(tracker_->expire());
  }
  void sent(bool sounds, const HandOver& counts) override { caller_.sent(sounds, counts); }
  void recording_rest(std::uint64_t frames) override { caller_.recording_rest(frames); }

  /// The fingers of the scenes that are over, and the names of those scenes' solids.
  const std::vector<FingerPressure>& pressures() const { return pressures_; }
  const std::vector<std::string>& names() const { return names_; }

 private:
  void tell(std::span<const Event> events) {
    if (sink_) sink_->write(events);
    caller_.events(events);
  }

  Plan loud_plan_;
  double loudest_ = 0;  ///< noise_of() of that plan
  std::span<const std::string> solids_;
  std::optional<PlayedParts> played_;
  std::optional<PressureLog> log_;  ///< of this scene
  std::vector<FingerPressure> pressures_;
  std::vector<std::string> names_;
  LiveFingers* fingers_ = nullptr;
  EventTracker* tracker_ = nullptr;
  EventSink* sink_;
  RunObserver& caller_;
};

/// The planner of a run: that of the session's scene, which may become another one between two frames.
class Session::ScenePlanner final : public Planner {
 public:
  /// All must outlive it. `tunes`: strides are tuned beside the loop while this object exists.
  ScenePlanner(Session& session, Observer& observer, RunChanges* changes, bool tunes)
      : session_(session), observer_(observer), changes_(changes), tunes_(tunes) {
    begin();
  }
  ~ScenePlanner() override { now().scheduler.tune_beside(nullptr); }
  ScenePlanner(const ScenePlanner&) = delete;
  ScenePlanner& operator=(const ScenePlanner&) = delete;

  bool busy() const override { return planner().busy(); }
  bool can_start() const override { return planner().can_start() && !(busy() && changes_ && changes_->has_scene()); }
  void start(const SkinFrame& frame) override {
    if (changes_) {
      if (!busy() && changes_->has_scene()) change();
      changes_->before_frame(session_);
    }
    planner().start(frame);
  }
  bool step(Plan& plan, FrameReport& report) override {
    if (!planner().step(plan, report)) return false;
    plan.schedule.solid_names = names_;
    if (std::exchange(silent_, false)) {
      plan.schedule.clear();
      plan.drives.clear();
      list_nothing(plan);
    }
    return true;
  }
  void warm_up() override { planner().warm_up(); }
  void set_effort(const Effort& effort) override { planner().set_effort(effort_ = effort); }
  Effort most_shed() const override { return planner().most_shed(); }
  void list_standing(bool lists) override { planner().list_standing(lists_ = lists); }
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) override { session_.set_pose(solid, T_world_rest); }

 private:
  State& now() const { return *session_.state_; }
  Planner& planner() const { return *now().planner; }

  void begin() {
    State& scene = now();
    if (scene.fingers) scene.fingers->begin();
    scene.scheduler.tune_beside(tunes_ && scene.field ? &*scene.field : nullptr);
    observer_.begin(scene.names, scene.fingers.get(), scene.setting.events ? &scene.tracker : nullptr);
  }
  /// Fingers are followed from the start, after a frame of silence.
  void change() {
    observer_.end();
    changes_->take_scene(session_);
    begin();
    planner().set_effort(effort_);
    planner().list_standing(lists_);
    names_ = std::make_shared<const std::vector<std::string>>(now().names);
    silent_ = true;
  }

  Session& session_;
  Observer& observer_;
  RunChanges* changes_;
  bool tunes_;
  Effort effort_;
  bool lists_ = false, silent_ = false;
  std::shared_ptr<const std::vector<std::string>> names_;  ///< of a scene that was not there at the beginning
};

Session::Session(SessionSetting setting) : state_(std::make_unique<State>(nullptr, std::move(setting))) {}
Session::Session(const gpu::Device& device, SessionSetting setting)
    : state_(std::make_unique<State>(&device, std::move(setting))) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

array::DrivenBy Session::driven_by() const {
  const SessionSetting& s = setting();
  array::DrivenBy by = array::driven_by(s.drive, s.layout.transducers.size(), state_->scheduler.needs_pressures());
  if (s.own_solver) by = {.weighting = s.drive.weighting};
  return by;
}
const SessionSetting& Session::setting() const {
  return state_->setting;
}
const std::vector<std::string>& Session::solid_names() const {
  return state_->names;
}
LinkSetting Session::link_setting() const {
  const SessionSetting& setting = state_->setting;
  return {.layout = setting.layout,
          .solid_names = state_->names,
          .slot_s = state_->scheduler.slot_s(),
          .foci_move = !touch::stands_still(setting.schedule.method.method),
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

LoopStats Session::run(sensing::DepthSource& source, Link& link, std::atomic<bool>& stop, const RunOptions& options,
                       const Clock& clock) {
  State& s = *state_;
  if (!s.setting.live())
    throw bad_usage("a session without a source of skin or without an array, or one of single frames, cannot run");
  if (s.fingers && options.every_frame) {
    throw bad_usage("foci on fingers follow the clock, not the frames: a run of every frame cannot have them");
  }
  check_run(s.setting, options.events != nullptr, "runs");
  Observer observer(options, s.setting.layout.transducers.size());
  observer.play_on(s.setting, link.boards());
  RunOptions loop = options;
  loop.observer = &observer;
  LoopStats stats;
  if (drops_points(s.setting)) stats.dropped.emplace();
  // The moment at which the field is known depends on the machine. So it is not used if every frame must have the same
  // result on all machines.
  ScenePlanner planner(*this, observer, options.changes, !options.every_frame);
  planner.list_standing(link.plays_plans());
  try {
    run_loop(source, planner, link,
             {.output = {s.setting.layout, s.setting.drive, s.scheduler.slot_s(), s.setting.hold_s, s.setting.safety},
              .lengthens_hold = s.setting.lengthens_hold},
             stop, loop, stats, clock);
  } catch (...) {
    const std::exception_ptr fault = std::current_exception();
    try {
      observer.end();
    } catch (const std::exception&) {  // the first error is the one to report
    }
    std::rethrow_exception(fault);
  }
  observer.end();
  const State& last = *state_;  // the scene may be another one than at the beginning
  if (last.setting.schedule.tune == Tune::stride) {
    const TuningThread* const tuning = last.scheduler.tuning();
    stats.tune = {tuning != nullptr, tuning ? tuning->known() : 0};
  }
  if (last.fingers) stats.finger_sounds = last.fingers->stats();
  if (const EarDrives ear = ear_drives(observer.loudest(), last.setting, options.steps); !ear.drives.empty())
    stats.ear = acoustics::ear_level(ear.played(), ear.ear);
  stats.fingers = observer.pressures();
  stats.solids = observer.names();
  stats.driven = driven_by();
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
  if (state_->setting.tracked) throw bad_usage("a session with a tracker takes its frames, not skin points");
  return state_->touch({.points = skin, .time_s = time_s, .captured_s = time_s, .first_slot = first_slot});
}

const touch::Touch& Session::touch(std::span<const sensing::DepthFrame> images, double time_s,
                                   std::optional<std::uint64_t> first_slot) {
  if (state_->setting.cameras.empty()) throw bad_usage("a session without cameras takes skin points, not depth frames");
  return state_->touch({.images = images, .time_s = time_s, .captured_s = time_s, .first_slot = first_slot});
}

const touch::Touch& Session::touch(std::span<const sensing::Capsule> hands, double time_s, std::uint64_t first_slot,
                                   bool in_doubt) {
  if (!state_->setting.tracked) throw bad_usage("a session without a tracker takes no hands");
  return state_->touch(
      {.capsules = hands, .in_doubt = in_doubt, .time_s = time_s, .captured_s = time_s, .first_slot = first_slot});
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

void Session::change_feel(std::uint32_t solid, const FeelChange& change) {
  if (!state_->setting.feel_may_change)
    throw bad_usage("a session whose setting has no feel_may_change keeps the feel that its solids have");
  state_->scheduler.change_feel(solid, change);
}

void Session::exchange_scene(Session& other) {
  other.state_->planner->number_from(state_->planner->next_id());
  other.state_->scheduler.take_over(state_->scheduler);
  other.state_->tracker.take_over(state_->tracker);
  std::swap(state_, other.state_);
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
