// The chain through the passes' C++ twins: one frame at a time on the calling thread.
#include "sensing/skin.hpp"
#include "session/chain.hpp"
#include "session/follow.hpp"
#include "touch/chain.hpp"

namespace palpa::session {
namespace {

class CpuChain : public Chain {
 public:
  explicit CpuChain(const ChainSetting& setting)
      : setting_(setting),
        box_(touchable_box(setting.solids)),
        tables_(sensing::make_rays(setting.cameras)),
        planes_(touch::make_plane_table(setting.solids)) {}

  bool can_start() const override { return !busy_; }
  bool busy() const override { return busy_; }

  void start(const sensing::FrameSet& frame, double captured_s, double now_s) override {
    sensing::plan_views(setting_.cameras, tables_, box_, views_);
    sensing::find_skin(tables_, frame.frames, box_, views_, points_);
    captured_s_ = captured_s;
    report_ = {frame.sequence, frame.time_s, &touch_, {}, now_s, 0};
    busy_ = true;
  }

  bool step(Plan& plan, FrameReport& report) override {
    touch::touch_points(points_, planes_, setting_.touch, touch_);
    make_schedule(touch_, follower_.follow(touch_), report_.time_s, setting_, plan.schedule);
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
  Box box_;
  sensing::RayTables tables_;
  touch::PlaneTable planes_;
  bool busy_ = false;
  double captured_s_ = 0;
  FrameReport report_;
  touch::Touch touch_;
  Follower follower_;

  std::vector<sensing::View> views_;
  std::vector<sensing::SkinPoint> points_;
  std::vector<array::SlotFocus> foci_;
  array::DriveScratch drive_scratch_;
  array::Schedule unmodulated_;
};

}  // namespace

std::unique_ptr<Chain> make_cpu_chain(const ChainSetting& setting) {
  return std::make_unique<CpuChain>(setting);
}

}  // namespace palpa::session
