// The chain on the device. A frame takes two submits: depth to foci, then, once the host has made the schedule, foci to
// drives. The hop over the host costs a fraction of a millisecond and keeps schedules and methods in plain C++.
#include <fmt/core.h>

#include <array>
#include <cstring>
#include <utility>

#include "array/drive_pass.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "gpu/commands.hpp"
#include "session/chain.hpp"
#include "touch/stage.hpp"

namespace palpa::session {
namespace {

constexpr std::size_t flights = 2;

/// Everything that one frame in flight writes to.
struct Flight {
  touch::StageMemory memory;
  array::DriveMemory drive_memory;
  gpu::Recorder touch_recorder, drive_recorder;
  gpu::Timestamps touch_times, drive_times;
  touch::Touch touch;

  enum class State { idle, touching, driving } state = State::idle;
  std::uint64_t submitted = 0;
  Plan plan;
  FrameReport report;

  Flight(const gpu::Device& device, const ChainSetting& setting, const touch::Stage& stage)
      : memory(stage),
        drive_memory(device, setting.layout, setting.drive, most_cycle, most_cycle * touch::max_fingers),
        touch_recorder(device, "touch"),
        drive_recorder(device, "drives"),
        touch_times(device, 24),
        drive_times(device, 4) {
    reserve(touch);
    reserve(plan.schedule);
  }
};

class GpuChain : public Chain {
 public:
  GpuChain(const gpu::Device& device, const ChainSetting& setting)
      : setting_(setting),
        passes_(device),
        stage_(passes_, setting.solids, setting.cameras,
               {.parameters = setting.touch,
                .detail = touch::needs_contacts(setting.method) ? touch::Detail::contacts : setting.detail,
                .follow = true}),
        array_passes_(device, setting.drive.solver),
        flights_{Flight(device, setting, stage_), Flight(device, setting, stage_)},
        timeline_(device, "frames") {
    reserve(unmodulated_);
    reserve(memory_);
    foci_.reserve(std::size_t{touch::max_fingers} * touch::max_foci);
    touch_ms_.reserve(24);
    drive_ms_.reserve(4);
  }

  bool can_start() const override { return started_ - finished_ < flights; }
  bool busy() const override { return started_ != finished_; }

  void start(const sensing::FrameSet& frame, double captured_s, double now_s) override {
    Flight& flight = flights_[started_ % flights];
    flight.memory.set(frame.frames);
    const VkCommandBuffer commands = flight.touch_recorder.begin();
    flight.touch_times.begin(commands);
    stage_.record(commands, flight.memory, frame.time_s, &flight.touch_times);
    flight.submitted = timeline_.submit(flight.touch_recorder.end());
    flight.state = Flight::State::touching;
    flight.plan.captured_s = captured_s;
    flight.report = {frame.sequence, frame.time_s, &flight.touch, {}, now_s, 0};
    ++started_;
  }

  bool step(Plan& plan, FrameReport& report) override {
    Flight& flight = flights_[finished_ % flights];
    if (flight.state == Flight::State::touching) {
      timeline_.wait(flight.submitted);
      begin_drives(flight);
      return false;
    }
    finish(flight, plan);
    report = flight.report;
    report.passes = touch_ms_;
    flight.state = Flight::State::idle;
    ++finished_;
    return true;
  }

 private:
  /// A frame with more skin in the shell than there is room for touches nothing: the loop goes on, and says so once.
  void read_touch(Flight& flight) {
    try {
      touch::read(flight.memory, flight.touch);
    } catch (const Error& error) {
      flight.touch.contacts.clear();
      flight.touch.deep.clear();
      flight.touch.finger_count = flight.touch.cluster_count = 0;
      if (!std::exchange(warned_, true)) log::warning(fmt::format("a frame was left out: {}", error.what()));
    }
  }

  void begin_drives(Flight& flight) {
    read_touch(flight);
    make_schedule(flight.touch, flight.report.time_s, setting_.solids, {setting_.method, setting_.voice, setting_.tune},
                  setting_.slot_s, memory_, flight.plan.schedule);
    flight.drive_memory.clear();
    plan_slots(flight.plan, unmodulated_, foci_, [&](std::span<const array::SlotFocus> foci) {
      if (!flight.drive_memory.add_slot(foci)) throw failure("a frame has more foci than its buffers hold");
    });
    flight.submitted = 0;
    if (flight.plan.cycle != 0) {
      const VkCommandBuffer commands = flight.drive_recorder.begin();
      flight.drive_times.begin(commands);
      flight.drive_memory.record(commands, array_passes_);
      flight.drive_times.mark(commands, "drives");
      flight.submitted = timeline_.submit(flight.drive_recorder.end());
    }
    flight.state = Flight::State::driving;
  }

  void finish(Flight& flight, Plan& plan) {
    flight.touch_times.read(touch_ms_);
    const std::size_t transducers = setting_.layout.transducers.size();
    plan.schedule = flight.plan.schedule;
    plan.captured_s = flight.plan.captured_s;
    plan.cycle = flight.plan.cycle;
    plan.shared_modulation_hz = flight.plan.shared_modulation_hz;
    plan.shared_modulation = flight.plan.shared_modulation;
    plan.drives.resize(plan.cycle * transducers);
    if (flight.submitted == 0) return;
    timeline_.wait(flight.submitted);
    for (std::uint32_t slot = 0; slot < plan.cycle; ++slot) {
      const auto drive = flight.drive_memory.drive(slot);
      std::memcpy(plan.drives.data() + slot * transducers, drive.data(), drive.size_bytes());
    }
    flight.drive_times.read(drive_ms_);
    touch_ms_.insert(touch_ms_.end(), drive_ms_.begin(), drive_ms_.end());
  }

  ChainSetting setting_;
  touch::Passes passes_;
  touch::Stage stage_;
  array::DrivePasses array_passes_;
  std::array<Flight, flights> flights_;
  gpu::Timeline timeline_;
  std::uint64_t started_ = 0, finished_ = 0;

  bool warned_ = false;

  // Scratch that keeps its storage.
  std::vector<array::SlotFocus> foci_;
  array::Schedule unmodulated_;
  ScheduleMemory memory_;
  std::vector<gpu::PassTime> touch_ms_, drive_ms_;
};

}  // namespace

std::unique_ptr<Chain> make_gpu_chain(const gpu::Device& device, const ChainSetting& setting) {
  return std::make_unique<GpuChain>(device, setting);
}

}  // namespace palpa::session
