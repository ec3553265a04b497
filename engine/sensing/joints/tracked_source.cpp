#include "sensing/joints/tracked_source.hpp"

#include <utility>

#include "sensing/joints/capsules.hpp"

namespace palpa::sensing {
namespace {

class TrackedSource final : public DepthSource {
 public:
  TrackedSource(std::unique_ptr<Tracker> tracker, const Transform& T_world_joints)
      : tracker_(std::move(tracker)), T_world_joints_(T_world_joints) {}

  const std::vector<Camera>& cameras() const override { return none_; }

  bool next(FrameSet& out, double timeout_s) override {
    out.frames.clear();
    out.capsules.clear();
    if (!tracker_->next(frame_, out.tracked, out.sequence, timeout_s)) return false;
    if (!out.tracked) return true;
    out.time_s = frame_.time_s;
    out.in_doubt = frame_.in_doubt;
    for (const TrackedHand& hand : frame_.hands)
      append_capsules(hand, T_world_joints_, out.capsules);
    return true;
  }

 private:
  std::unique_ptr<Tracker> tracker_;
  Transform T_world_joints_;
  std::vector<Camera> none_;
  TrackedFrame frame_;
};

}  // namespace

std::unique_ptr<DepthSource> make_tracked_source(std::unique_ptr<Tracker> tracker, const Transform& T_world_joints) {
  return std::make_unique<TrackedSource>(std::move(tracker), T_world_joints);
}

}  // namespace palpa::sensing
