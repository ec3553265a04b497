// The planner with the passes' C++ twins: one frame at a time on the calling thread.
#include <chrono>
#include <optional>

#include "session/plan/planner.hpp"
#include "session/predict/predictor.hpp"
#include "touch/host_stage.hpp"

namespace palpa::session {
namespace {

class HostPlanner : public Planner {
 public:
  HostPlanner(const SessionSetting& setting, Scheduler& scheduler, FingerSounds* sounds)
      : setting_(setting),
        scheduler_(scheduler),
        stage_(setting.solids, setting.cameras, stage_setting(setting, scheduler)) {
    if (scheduler.needs_pressures() && !setting.layout.transducers.empty())
      loudness_.emplace(setting.layout, setting.drive);
    if (sounds) on_fingers_.emplace(setting, scheduler, *sounds);
    if (setting.predict.predict == Predict::off) return;
    predictor_.emplace(predictor_setting(
        setting, scheduler, {stage_.cameras(), stage_.rays(), &stage_.setting().surroundings}, stage_.solids()));
    kept_ = predictor_->make_kept();
  }

  bool can_start() const override { return !busy_; }
  bool busy() const override { return busy_; }

  void start(const SkinFrame& frame) override {
    passes_.clear();
    begin_ = Clock::now();
    const auto mark = [this](const char* pass) { this->mark(pass); };
    if (setting_.cameras.empty()) {
      stage_.touch(frame.points, touch_, frame.time_s, mark);
    } else {
      stage_.touch(frame.images, touch_, frame.time_s, mark);
    }
    if (predictor_) predictor_->keep(frame.images, kept_);
    frame_ = frame;
    frame_.images = {};
    frame_.points = {};
    report_ = {frame.sequence, frame.time_s, &touch_, {}, frame.arrived_s, 0};
    busy_ = true;
  }

  bool step(Plan& plan, FrameReport& report) override {
    busy_ = false;
    const touch::Touch& touch = predictor_ ? predictor_->see(touch_, report_.time_s, frame_.first(), kept_) : touch_;
    scheduler_.make(touch, report_.time_s, plan.schedule);
    if (predictor_) report_.prediction = predictor_->advance(plan.schedule);
    plan.captured_s = frame_.captured_s;
    make_drives(plan);
    report = report_;
    report.passes = passes_;
    return true;
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
  using Clock = std::chrono::steady_clock;

  void mark(const char* pass) {
    const auto now = Clock::now();
    passes_.push_back({pass, std::chrono::duration<double, std::milli>(now - begin_).count()});
    begin_ = now;
  }

  void make_drives(Plan& plan) {
    plan.drives.clear();
    list_nothing(plan);
    if (setting_.layout.transducers.empty()) return;
    if (setting_.own_solver)
      return drive_by_own(plan, setting_.layout, setting_.drive, setting_.own_solver, slot_work_);
    if (on_fingers_ && on_fingers_->make(plan)) return;
    drive_on_host(plan, setting_.layout, setting_.drive, slot_work_, loudness_ ? &*loudness_ : nullptr, drive_scratch_);
  }

  const SessionSetting& setting_;
  Scheduler& scheduler_;
  touch::HostStage stage_;
  bool busy_ = false;
  SkinFrame frame_;  // without its skin
  KeptFrames kept_;
  FrameReport report_;
  touch::Touch touch_;
  std::vector<gpu::PassTime> passes_;
  Clock::time_point begin_;

  SlotWork slot_work_;
  array::DriveScratch drive_scratch_;
  std::optional<array::Loudness> loudness_;
  std::optional<Predictor> predictor_;
  std::optional<FingerDrives> on_fingers_;
};

}  // namespace

std::unique_ptr<Planner> make_host_planner(const SessionSetting& setting, Scheduler& scheduler, FingerSounds* sounds) {
  return std::make_unique<HostPlanner>(setting, scheduler, sounds);
}

}  // namespace palpa::session
