// The planner on the device. A frame takes two submits: first skin to foci, then, after the host has made the schedule,
// foci to drives. The detour over the host costs a fraction of a millisecond and keeps schedules and methods in plain
// C++.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <complex>
#include <cstring>
#include <optional>
#include <utility>

#include "array/drive_pass.hpp"
#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "gpu/commands.hpp"
#include "session/plan/planner.hpp"
#include "session/predict/predictor.hpp"
#include "touch/stage.hpp"

namespace palpa::session {
namespace {

constexpr std::uint32_t most_passes = 24;

/// Everything that one frame in flight writes to.
struct Flight {
  touch::StageMemory memory;
  std::optional<array::DriveMemory> drive_memory;
  gpu::Recorder touch_recorder, drive_recorder;
  gpu::Timestamps touch_times, drive_times;
  touch::Touch touch;

  enum class State { idle, touching, driving } state = State::idle;
  std::uint64_t submitted = 0;
  SkinFrame frame;  // without its skin
  KeptFrames kept;
  Plan plan;
  bool on_host = false;  ///< the plan's drives are in it
  double on_host_ms = 0;
  FrameReport report;

  Flight(const gpu::Device& device, const SessionSetting& setting, const touch::Stage& stage)
      : memory(stage),
        touch_recorder(device, "touch"),
        drive_recorder(device, "drives"),
        touch_times(device, most_passes),
        drive_times(device, 4) {
    if (!setting.layout.transducers.empty()) {
      drive_memory.emplace(device, setting.layout, setting.drive, most_cycle, most_cycle * touch::max_fingers);
    }
    if (setting.live()) reserve(touch);
    reserve(plan.schedule);
  }
};

class GpuPlanner : public Planner {
 public:
  GpuPlanner(const gpu::Device& device, const SessionSetting& setting, Scheduler& scheduler, FingerSounds* sounds)
      : setting_(setting),
        scheduler_(scheduler),
        passes_(device),
        stage_(passes_, setting.solids, setting.cameras, stage_setting(setting, scheduler)),
        timeline_(device, "frames") {
    if (setting.predict.predict != Predict::off)
      predictor_.emplace(predictor_setting(
          setting, scheduler, {stage_.cameras(), stage_.rays(), &stage_.setting().surroundings}, stage_.solids()));
    if (!setting.layout.transducers.empty()) {
      drive_passes_.emplace(device, setting.drive.solver);
      if (scheduler.needs_pressures()) loudness_.emplace(setting.layout, setting.drive);
      if (sounds) on_fingers_.emplace(setting, scheduler, *sounds);
    }
    for (std::size_t f = 0; f < (setting.live() ? 2U : 1U); ++f)
      flights_.push_back(std::make_unique<Flight>(device, setting, stage_));
    for (const auto& flight : flights_) {
      if (predictor_) flight->kept = predictor_->make_kept();
    }
    reserve(slot_work_.unmodulated);
    slot_work_.foci.reserve(std::size_t{touch::max_fingers} * touch::max_foci);
    touch_ms_.reserve(most_passes + 4);
    drive_ms_.reserve(4);
  }

  /// Not before the drives of the current frame are submitted; otherwise, they would come after all of the next frame's
  /// work.
  bool can_start() const override {
    return !busy() || (started_ - finished_ < flights_.size() &&
                       flights_[finished_ % flights_.size()]->state == Flight::State::driving);
  }
  bool busy() const override { return started_ != finished_; }

  void start(const SkinFrame& frame) override {
    Flight& flight = flight_of(started_);
    setting_.cameras.empty() ? flight.memory.set(frame.points) : flight.memory.set(frame.images);
    const VkCommandBuffer commands = flight.touch_recorder.begin();
    flight.touch_times.begin(commands);
    stage_.record(commands, flight.memory, frame.time_s, &flight.touch_times);
    flight.submitted = timeline_.submit(flight.touch_recorder.end());
    flight.state = Flight::State::touching;
    if (predictor_) predictor_->keep(frame.images, flight.kept);
    flight.frame = frame;
    flight.frame.images = {};
    flight.frame.points = {};
    flight.plan.captured_s = frame.captured_s;
    flight.report = {frame.sequence, frame.time_s, &flight.touch, {}, frame.arrived_s, 0};
    ++started_;
  }

  bool step(Plan& plan, FrameReport& report) override {
    Flight& flight = flight_of(finished_);
    try {
      if (flight.state == Flight::State::touching) {
        timeline_.wait(flight.submitted);
        read_touch(flight);
        plan_on_host(flight);
        submit_drives(flight);
        return false;
      }
      finish(flight, plan);
    } catch (...) {
      done(flight);
      throw;
    }
    report = flight.report;
    report.passes = touch_ms_;
    done(flight);
    return true;
  }

  void warm_up() override {
    if (started_ != 0) return;  // done by earlier frames
    const Activity work("compiling shaders, which the driver keeps for the next time");
    // Two frames without skin, one for each in flight, dispatch all kernels up to the foci. The kernels have no work.
    std::vector<sensing::DepthFrame> dark(setting_.cameras.size());
    for (std::size_t c = 0; c < dark.size(); ++c)
      dark[c].depth.assign(std::size_t{setting_.cameras[c].width} * setting_.cameras[c].height, 0);
    FrameReport report;
    for (std::size_t f = 0; f < flights_.size(); ++f) {
      start({.images = dark});
      while (!step(flight_of(f).plan, report)) {
      }
    }
    stage_.forget();  // they were no frames of the source
    warm_up_drives(*flights_.front());
  }

  void set_pose(std::uint32_t solid, const Transform& T_world_rest) override { stage_.set_pose(solid, T_world_rest); }

  void list_standing(bool lists) override { slot_work_.lists_standing = lists; }

  void set_effort(const Effort& effort) override {
    stage_.set_pixel_stride(effort.pixel_stride);
    if (predictor_) predictor_->set_pixel_stride(effort.pixel_stride);
    scheduler_.thin_foci(effort.foci_part);
  }
  Effort most_shed() const override { return {stage_.most_pixel_stride(), most_foci_part}; }

 private:
  Flight& flight_of(std::uint64_t frame) { return *flights_[frame % flights_.size()]; }

  void done(Flight& flight) {
    flight.state = Flight::State::idle;
    ++finished_;
  }

  /// In a live session, a frame with more skin in the shell than there is room for touches nothing. The loop continues
  /// and warns once.
  void read_touch(Flight& flight) {
    try {
      touch::read(flight.memory, flight.touch);
    } catch (const Error& error) {
      if (!setting_.live()) throw;
      flight.touch.contacts.clear();
      flight.touch.deep.clear();
      flight.touch.dropped = {};
      flight.touch.finger_count = flight.touch.cluster_count = 0;
      if (!std::exchange(warned_, true)) log::warning(fmt::format("a frame was left out: {}", error.what()));
    }
  }

  /// The part on the host: the fingers' schedule, and the foci of each slot of its cycle.
  void plan_on_host(Flight& flight) {
    const double time_s = flight.report.time_s;
    const touch::Touch& touch =
        predictor_ ? predictor_->see(flight.touch, time_s, flight.frame.first(), flight.kept) : flight.touch;
    scheduler_.make(touch, time_s, flight.plan.schedule);
    if (predictor_) flight.report.prediction = predictor_->advance(flight.plan.schedule);
    list_nothing(flight.plan);
    flight.on_host = false;
    if (!flight.drive_memory) return;
    if (setting_.own_solver || on_fingers_) {
      const auto begin = std::chrono::steady_clock::now();
      flight.on_host = make_on_host(flight.plan);
      flight.on_host_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
      if (flight.on_host) return;
    }
    array::DriveMemory& memory = *flight.drive_memory;
    memory.clear();
    plan_slots(flight.plan, slot_work_, loudness_ ? &*loudness_ : nullptr, [&](const auto& foci, const auto& factors) {
      const bool fits = factors.empty() ? memory.add_slot(foci) : memory.add_slot(foci, factors);
      if (!fits) throw failure("a frame has more foci than its buffers hold");
    });
  }

  /// False if the device computes the drives.
  bool make_on_host(Plan& plan) {
    if (!setting_.own_solver) return on_fingers_->make(plan);
    drive_by_own(plan, setting_.layout, setting_.drive, setting_.own_solver, slot_work_);
    return true;
  }

  void submit_drives(Flight& flight) {
    flight.state = Flight::State::driving;
    flight.submitted = 0;
    if (!flight.plan.cycle.is_listed() || flight.on_host) return;
    const VkCommandBuffer commands = flight.drive_recorder.begin();
    flight.drive_times.begin(commands);
    flight.drive_memory->record(commands, *drive_passes_);
    flight.drive_times.mark(commands, "drives");
    flight.submitted = timeline_.submit(flight.drive_recorder.end());
  }

  /// Slots of one focus, of two, and so on up to the maximum that sounds together, because the kernels depend on this
  /// number.
  void warm_up_drives(Flight& flight) {
    if (!flight.drive_memory) return;
    array::DriveMemory& memory = *flight.drive_memory;
    const auto dispatch = [&] {
      memory.record(flight.drive_recorder.begin(), *drive_passes_);
      timeline_.wait(timeline_.submit(flight.drive_recorder.end()));
    };
    std::vector<array::SlotFocus>& foci = slot_work_.foci;
    memory.clear();
    foci.clear();
    for (std::uint32_t count = 1; count <= touch::max_foci; count *= 2) {
      while (foci.size() < count)
        foci.push_back({.position = {30e-3 * static_cast<double>(foci.size()), 0, 0}});
      if (!memory.add_slot(foci)) break;
    }
    dispatch();
    if (!loudness_) return;
    memory.clear();
    foci.resize(2);
    const std::complex<double> factors[2] = {};
    if (memory.add_slot(foci, factors)) dispatch();
  }

  void finish(Flight& flight, Plan& plan) {
    flight.touch_times.read(touch_ms_);
    const std::size_t transducers = setting_.layout.transducers.size();
    plan.schedule = flight.plan.schedule;
    plan.captured_s = flight.plan.captured_s;
    plan.cycle = flight.plan.cycle;
    plan.standing = flight.plan.standing;
    plan.drives.resize(plan.listed() * transducers);
    if (flight.on_host) {
      std::ranges::copy(flight.plan.drives, plan.drives.begin());
      touch_ms_.push_back({setting_.own_solver ? "own solver" : "drives on fingers", flight.on_host_ms});
    }
    if (flight.submitted == 0) return;
    timeline_.wait(flight.submitted);
    for (std::uint32_t slot = 0; slot < plan.listed(); ++slot) {
      const auto drive = flight.drive_memory->drive(slot);
      std::memcpy(plan.drives.data() + slot * transducers, drive.data(), drive.size_bytes());
    }
    flight.drive_times.read(drive_ms_);
    touch_ms_.insert(touch_ms_.end(), drive_ms_.begin(), drive_ms_.end());
  }

  const SessionSetting& setting_;
  Scheduler& scheduler_;
  touch::Passes passes_;
  touch::Stage stage_;
  std::optional<array::DrivePasses> drive_passes_;
  std::optional<array::Loudness> loudness_;
  std::optional<Predictor> predictor_;
  std::optional<FingerDrives> on_fingers_;
  std::vector<std::unique_ptr<Flight>> flights_;
  gpu::Timeline timeline_;
  std::uint64_t started_ = 0, finished_ = 0;
  bool warned_ = false;

  // Scratch that keeps its storage.
  SlotWork slot_work_;
  std::vector<gpu::PassTime> touch_ms_, drive_ms_;
};

}  // namespace

std::unique_ptr<Planner> make_gpu_planner(const gpu::Device& device, const SessionSetting& setting,
                                          Scheduler& scheduler, FingerSounds* sounds) {
  return std::make_unique<GpuPlanner>(device, setting, scheduler, sounds);
}

}  // namespace palpa::session
