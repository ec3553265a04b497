// The chain through the passes' C++ twins: one frame at a time on the calling thread.
#include "session/chain.hpp"
#include "touch/host_stage.hpp"

namespace palpa::session {
namespace {

class CpuChain : public Chain {
 public:
  explicit CpuChain(const ChainSetting& setting)
      : setting_(setting), stage_(setting.solids, setting.cameras, {.parameters = setting.touch, .follow = true}) {}

  bool can_start() const override { return !busy_; }
  bool busy() const override { return busy_; }

  void start(const sensing::FrameSet& frame, double captured_s, double now_s) override {
    stage_.touch(frame.frames, touch_, frame.time_s);
    captured_s_ = captured_s;
    report_ = {frame.sequence, frame.time_s, &touch_, {}, now_s, 0};
    busy_ = true;
  }

  bool step(Plan& plan, FrameReport& report) override {
    make_schedule(touch_, report_.time_s, setting_.solids, {setting_.method, setting_.voice, setting_.tune},
                  setting_.slot_s, memory_, plan.schedule);
    plan.captured_s = captured_s_;
    plan.drives.clear();
    const std::size_t transducers = setting_.layout.transducers.size();
    plan_slots(plan, unmodulated_, foci_, [&](std::span<const array::SlotFocus> foci) {
      plan.drives.resize(plan.drives.size() + transducers);
      array::drive_for(setting_.layout, foci, setting_.drive, std::span(plan.drives).last(transducers), drive_scratch_);
    });
    report = report_;
    busy_ = false;
    return true;
  }

 private:
  ChainSetting setting_;
  touch::HostStage stage_;
  bool busy_ = false;
  double captured_s_ = 0;
  FrameReport report_;
  touch::Touch touch_;

  std::vector<array::SlotFocus> foci_;
  array::DriveScratch drive_scratch_;
  array::Schedule unmodulated_;
  ScheduleMemory memory_;
};

}  // namespace

std::unique_ptr<Chain> make_cpu_chain(const ChainSetting& setting) {
  return std::make_unique<CpuChain>(setting);
}

}  // namespace palpa::session
