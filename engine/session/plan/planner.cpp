#include "session/plan/planner.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "array/drive.hpp"
#include "array/drive_pass.hpp"
#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "session/plan/device_drives.hpp"
#include "session/plan/finger_drives.hpp"
#include "session/predict/predictor.hpp"
#include "session/watch/effort.hpp"
#include "session/watch/hand_watch.hpp"
#include "touch/pass_watch.hpp"
#include "touch/points/passes.hpp"
#include "touch/points/points.hpp"
#include "touch/stage.hpp"

namespace palpa::session {
namespace {

constexpr std::size_t most_times = 40;

/// Depth frames that are processed one by one may show a whole hand in a solid, with more contacts than a frame of a
/// loop has.
constexpr std::uint32_t most_contacts_of_one = 1U << 20;

/// A frame in progress.
struct Flight {
  SkinFrame frame;
  KeptFrames kept;
  touch::Touch touch;
  Plan plan;
  FrameReport report;
  std::vector<gpu::PassTime> times;
  std::optional<DeviceDrives> drives;

  enum class State { idle, touching, driving } state = State::idle;
};

/// From a frame to a plan: the stage finds fingers, the predictor moves them, the scheduler makes their schedule, and
/// the drives of its slots are computed. On a device, points and drives take a submit each, with the host between them:
/// this costs a fraction of a millisecond, and keeps fingers, schedules and methods in plain C++.
class FramePlanner : public Planner {
 public:
  FramePlanner(const gpu::Device* device, const SessionSetting& setting, Scheduler& scheduler, FingerSounds* sounds)
      : setting_(setting),
        scheduler_(scheduler),
        passes_(device ? std::optional<touch::Passes>(std::in_place, *device) : std::nullopt),
        stage_(passes_ ? touch::Stage(*passes_, setting.solids, setting.cameras, stage_setting(setting))
                       : touch::Stage(setting.solids, setting.cameras, stage_setting(setting))) {
    if (!setting.cameras.empty())
      hand_watch_.emplace(stage_.cameras(), stage_.rays(), stage_.setting().surroundings.slabs);
    if (setting.predict.predict != Predict::off)
      predictor_.emplace(predictor_setting(
          setting, scheduler, {stage_.cameras(), stage_.rays(), &stage_.setting().surroundings}, stage_.solids()));
    const bool drives = !setting.layout.transducers.empty();
    if (drives && scheduler.needs_pressures()) loudness_.emplace(setting.layout, setting.drive);
    if (drives && sounds) on_fingers_.emplace(setting, scheduler, *sounds);
    if (drives && device) drive_passes_.emplace(*device, setting.drive.solver);
    reserve(slot_work_);
    // Nothing waits for the slots of single frames.
    if (drives && !setting.frame_by_frame) {
      slot_work_.most_unlisted_foci =
          array::quick_foci(setting.layout.transducers.size(), setting.drive, scheduler.slot_s());
    }
    if (drives && !device && setting.live())
      slot_drives_.reserve(setting.layout, setting.drive, most_cycle, std::size_t{most_cycle} * touch::max_fingers);
    // Frames overlap only where the device computes drives.
    flights_.resize(drive_passes_ && setting.live() ? 2 : 1);
    for (std::unique_ptr<Flight>& flight : flights_) {
      flight = std::make_unique<Flight>();
      if (drive_passes_) flight->drives.emplace(*device, setting, *drive_passes_, loudness_ ? &*loudness_ : nullptr);
      if (predictor_) flight->kept = predictor_->make_kept();
      if (setting.live()) reserve(flight->touch);
      reserve(flight->plan, setting.live() ? setting.layout.transducers.size() : 0);
      flight->times.reserve(most_times);
    }
  }

  /// Not before the drives of the current frame are submitted; otherwise, they would come after all of the next frame's
  /// work.
  bool can_start() const override {
    return !busy() || (started_ - finished_ < flights_.size() && flight_of(finished_).state == Flight::State::driving);
  }
  bool busy() const override { return started_ != finished_; }

  void start(const SkinFrame& frame) override {
    Flight& flight = flight_of(started_);
    if (!setting_.cameras.empty()) {
      stage_.start(frame.images, frame.time_s);
    } else if (setting_.tracked) {
      stage_.start(frame.capsules, frame.time_s);
    } else {
      stage_.start(frame.points, frame.time_s);
    }
    if (predictor_) predictor_->keep(frame.images, flight.kept);
    flight.frame = frame;
    flight.plan.captured_s = frame.captured_s;
    flight.report = {frame.sequence, frame.time_s, &flight.touch, {}, frame.arrived_s, 0};
    flight.report.hands = hands_in(frame);
    flight.state = Flight::State::touching;
    ++started_;
  }

  bool step(Plan& plan, FrameReport& report) override {
    Flight& flight = flight_of(finished_);
    try {
      if (flight.state == Flight::State::touching) {
        find_touch(flight);
        make_schedule(flight);
        if (start_drives(flight)) {
          flight.state = Flight::State::driving;
          return false;
        }
      } else {
        flight.drives->finish(flight.plan, flight.times);
      }
    } catch (...) {
      done(flight);
      throw;
    }
    std::swap(plan, flight.plan);
    report = flight.report;
    report.passes = flight.times;
    done(flight);
    return true;
  }

  void warm_up() override {
    if (started_ != 0 || !passes_) return;  // done by earlier frames, or nothing to do
    const Activity work("compiling shaders, which the driver keeps for the next time");
    // A frame without skin dispatches all kernels up to the clusters. The kernels have no work.
    std::vector<sensing::DepthFrame> dark(setting_.cameras.size());
    for (std::size_t c = 0; c < dark.size(); ++c)
      dark[c].depth.assign(std::size_t{setting_.cameras[c].width} * setting_.cameras[c].height, 0);
    Plan plan;
    FrameReport report;
    start({.images = dark});
    while (!step(plan, report)) {
    }
    stage_.forget();  // it was no frame of the source
    if (drive_passes_) flights_.front()->drives->warm_up(slot_work_);
  }

  void set_pose(std::uint32_t solid, const Transform& T_world_rest) override {
    stage_.set_pose(solid, T_world_rest);
    scheduler_.set_pose(solid, T_world_rest);
  }

  std::uint32_t next_id() const override { return stage_.next_id(); }
  void number_from(std::uint32_t id) override { stage_.number_from(id); }

  void list_standing(bool lists) override { slot_work_.lists_standing = lists; }

  void set_effort(const Effort& effort) override {
    stage_.set_pixel_stride(effort.pixel_stride);
    if (predictor_) predictor_->set_pixel_stride(effort.pixel_stride);
    scheduler_.thin_foci(effort.foci_part);
  }
  Effort most_shed() const override { return {stage_.most_pixel_stride(), most_foci_part}; }

 private:
  Flight& flight_of(std::uint64_t frame) const { return *flights_[frame % flights_.size()]; }

  /// With cameras, find_touch() says it.
  std::optional<std::uint32_t> hands_in(const SkinFrame& frame) const {
    if (frame.in_doubt) return std::nullopt;
    if (setting_.tracked) return static_cast<std::uint32_t>(frame.capsules.size());
    return setting_.cameras.empty() && frame.points.empty() ? 0 : 1;
  }

  void done(Flight& flight) {
    flight.state = Flight::State::idle;
    ++finished_;
  }

  /// In a live session, a frame with more skin in the shell than there is room for touches nothing. The loop continues
  /// and warns once.
  void find_touch(Flight& flight) {
    try {
      stage_.finish(flight.touch);
    } catch (const touch::TooMuchSkin& error) {
      if (!setting_.live()) throw;
      flight.touch.contacts.clear();
      flight.touch.deep.clear();
      flight.touch.dropped = {};
      flight.touch.finger_count = flight.touch.cluster_count = 0;
      if (!std::exchange(warned_, true)) log::warning(fmt::format("a frame was left out: {}", error.what()));
    }
    flight.times.assign(stage_.times().begin(), stage_.times().end());
    if (hand_watch_)
      flight.report.hands = hand_watch_->hands_in(flight.frame.images, flight.touch, flight.report.time_s);
    flight.frame.images = {};  // no longer needed, and no longer there
    flight.frame.points = {};
    flight.frame.capsules = {};
  }

  void make_schedule(Flight& flight) {
    const double time_s = flight.report.time_s;
    const std::optional<FirstSlot> first = flight.frame.first();
    const touch::Touch& touch = predictor_ ? predictor_->see(flight.touch, time_s, first, flight.kept) : flight.touch;
    scheduler_.make(touch, time_s, flight.plan.schedule,
                    {setting_.follow, first ? std::optional(first->slot) : std::nullopt, flight.report.hands});
    slot_work_.first_slot = first ? first->slot : 0;
    if (predictor_) flight.report.prediction = predictor_->advance(flight.plan.schedule);
  }

  /// Returns whether the device computes them.
  bool start_drives(Flight& flight) {
    Plan& plan = flight.plan;
    plan.drives.clear();
    list_nothing(plan);
    if (setting_.layout.transducers.empty()) return false;
    touch::PassWatch watch(flight.times);
    if (setting_.own_solver) {
      drive_by_own(plan, setting_.layout, setting_.drive, setting_.own_solver, slot_work_);
      watch.mark("own solver");
      return false;
    }
    if (on_fingers_ && on_fingers_->make(plan, slot_work_)) {
      watch.mark("drives on fingers");
      return false;
    }
    if (flight.drives) return flight.drives->start(plan, slot_work_, flight.times);
    drive_on_host(plan, setting_.layout, setting_.drive, slot_work_, loudness_ ? &*loudness_ : nullptr, slot_drives_);
    watch.mark("drives");
    return false;
  }

  const SessionSetting& setting_;
  Scheduler& scheduler_;
  std::optional<touch::Passes> passes_;  // on a device
  touch::Stage stage_;
  std::optional<HandWatch> hand_watch_;
  std::optional<Predictor> predictor_;
  std::optional<array::Loudness> loudness_;
  std::optional<FingerDrives> on_fingers_;
  std::optional<array::DrivePasses> drive_passes_;  // on a device
  std::vector<std::unique_ptr<Flight>> flights_;
  std::uint64_t started_ = 0, finished_ = 0;
  bool warned_ = false;

  // Scratch that keeps its storage.
  SlotWork slot_work_;
  array::SlotDrives slot_drives_;
};

}  // namespace

void reserve(touch::Touch& touch) {
  touch.contacts.reserve(touch::max_fingers * contacts_per_finger);
  touch.deep.reserve(most_deep);
  touch.fingers.resize(touch::max_fingers);
  for (touch::Finger& finger : touch.fingers) {
    finger.contacts.reserve(contacts_per_finger);
    finger.foci.reserve(touch::max_foci);
  }
}

PredictorSetting predictor_setting(const SessionSetting& setting, const Scheduler& scheduler, const CameraView& view,
                                   const touch::PreparedSolids& solids) {
  const array::Voice voice = scheduler.common_voice();
  const std::size_t steps = voice.order.size() / voice.foci_per_slot;
  const double cycle = std::round(static_cast<double>(steps) * voice.dwell_s / scheduler.slot_s());
  return {.options = setting.predict,
          .view = view,
          .solids = solids,
          .parameters = setting.touch,
          .cycle = static_cast<std::uint32_t>(std::clamp(cycle, 1.0, 1e3)),
          .slot_s = scheduler.slot_s()};
}

touch::StageSetting stage_setting(const SessionSetting& setting) {
  touch::StageSetting stage{.parameters = setting.touch,
                            .follow = setting.follow,
                            .axes = setting.axes,
                            .smoothing = setting.smoothing,
                            .hysteresis = setting.hysteresis,
                            .memory_s = setting.hold_s,
                            .kept_solids = setting.kept_solids};
  if (!setting.cameras.empty()) stage.surroundings = surroundings_of(setting);
  if (setting.tracked) {
    stage.surroundings.room = setting.surroundings.room;
    stage.most_points = sensing::most_hand_points;
  }
  stage.most_contacts = setting.live() || setting.cameras.empty() ? 0 : most_contacts_of_one;
  if (setting.events || setting.feel_may_change || needs_depths(setting.solids)) stage.parameters.deep = true;
  return stage;
}

std::unique_ptr<Planner> make_planner(const gpu::Device* device, const SessionSetting& setting, Scheduler& scheduler,
                                      FingerSounds* sounds) {
  return std::make_unique<FramePlanner>(device, setting, scheduler, sounds);
}

}  // namespace palpa::session
