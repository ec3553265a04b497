#include "setup/sessions/hand_follower.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <glm/mat4x4.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "sensing/joints/hand_pose.hpp"
#include "sensing/joints/tracker.hpp"
#include "session/links/spec.hpp"
#include "session/loop/source_clock.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/tracker.hpp"

namespace palpa::setup {
namespace {

std::size_t joint_of(On on) {
  if (on == On::palm) return sensing::palm_joint;
  if (on == On::wrist) return sensing::wrist_joint;
  return sensing::finger_joints[static_cast<std::size_t>(on) - static_cast<std::size_t>(On::thumb)].second;
}

/// Work on a thread of its own; its end, or its error, sets `stop`.
class Following : public HandFollower {
 public:
  Following(session::Anchor& anchor, std::atomic<bool>& stop) : anchor_(anchor), stop_(stop) {}

  void end() override {
    if (!thread_.joinable()) return;
    over_ = true;
    thread_.join();
    if (fault_) std::rethrow_exception(fault_);
  }

 protected:
  template <typename Work>
  void start(const session::Clock& clock, Work work) {
    thread_ = clock.start("--on", [this, work] {
      try {
        work();
      } catch (...) {
        fault_ = std::current_exception();
      }
      anchor_.lose();
      stop_ = true;
    });
  }
  /// For the destructor of the most derived class.
  void drop() {
    try {
      end();
    } catch (...) {  // the earlier error is the one to report
    }
  }

  session::Anchor& anchor_;
  std::atomic<bool>& stop_;
  std::atomic<bool> over_{false};

 private:
  std::thread thread_;
  std::exception_ptr fault_;
};

class JointFollower final : public Following {
 public:
  JointFollower(On on, std::unique_ptr<sensing::Tracker> tracker, const Transform& T_array_joints,
                session::Anchor& anchor, std::atomic<bool>& stop, const session::Clock& clock)
      : Following(anchor, stop), joint_(joint_of(on)), tracker_(std::move(tracker)), T_array_joints_(T_array_joints) {
    start(clock, [this, &clock] { follow(clock); });
  }
  ~JointFollower() override { drop(); }

 private:
  void follow(const session::Clock& clock) {
    constexpr double look_s = 0.02;
    session::SourceClock source_clock;
    sensing::TrackedFrame frame;
    bool came = false;
    std::uint64_t number = 0;
    while (!over_ && tracker_->next(frame, came, number, look_s)) {
      if (!came) continue;
      const double captured_s = source_clock.capture_time(frame.time_s, clock.now());
      const sensing::TrackedHand* const hand = chosen(frame);
      if (hand) {
        anchor_.see(T_array_joints_ * sensing::pose_of_joint(*hand, joint_), captured_s);
      } else {
        anchor_.lose();
      }
    }
  }
  const sensing::TrackedHand* chosen(const sensing::TrackedFrame& frame) {
    if (frame.hands.empty()) return nullptr;
    const auto same = std::ranges::find(frame.hands, left_, &sensing::TrackedHand::left);
    const sensing::TrackedHand& hand = same != frame.hands.end() ? *same : frame.hands.front();
    left_ = hand.left;
    return &hand;
  }

  std::size_t joint_;
  std::unique_ptr<sensing::Tracker> tracker_;
  Transform T_array_joints_;
  bool left_ = false;
};

/// A session without sound that looks for the finger.
class FingerFollower final : public Following, public session::RunObserver {
 public:
  FingerFollower(const FrameOptions& frames, std::span<const session::SourceKind> sources,
                 const Transform& T_world_array, session::Anchor& anchor, std::atomic<bool>& stop,
                 const session::Clock& clock)
      : Following(anchor, stop),
        prepared_(prepare(frames, sources, true)),
        silent_(session::open_link("null", session::builtin_links(), prepared_.session->link_setting())),
        T_array_world_(glm::inverse(T_world_array)),
        clock_(clock) {
    start(clock, [this] { prepared_.session->run(*prepared_.source, *silent_, over_, {.observer = this}); });
  }
  ~FingerFollower() override { drop(); }

  void planned(const session::FrameReport& report, const session::Plan&) override {
    const touch::Touch& touch = *report.touch;
    if (touch.finger_count == 0) return anchor_.lose();
    const std::span fingers = std::span(touch.fingers).first(touch.finger_count);
    const auto same = std::ranges::find(fingers, finger_, &touch::Finger::id);
    const touch::Finger& finger = same != fingers.end() ? *same : fingers.front();
    finger_ = finger.id;
    // Parallel to the array: a finger's axes are those of its contacts, and turn with every frame.
    Transform pose(1.0);
    pose[3] = Vec4(transform_point(T_array_world_, Vec3(finger.section.centroid)), 1);
    anchor_.see(pose, clock_.now() - (report.planned_s - report.arrived_s));
  }
  void expired() override { anchor_.lose(); }

 private:
  Prepared prepared_;
  std::unique_ptr<session::Link> silent_;
  Transform T_array_world_;
  const session::Clock& clock_;
  std::uint32_t finger_ = 0;
};

}  // namespace

std::unique_ptr<HandFollower> follow_hand(On on, const FrameOptions& frames,
                                          std::span<const session::SourceKind> sources, const Transform& T_world_array,
                                          session::Anchor& anchor, std::atomic<bool>& stop,
                                          const session::Clock& clock) {
  if (on == On::finger) {
    FrameOptions watched = frames;
    watched.watched = true;
    check(watched);
    return std::make_unique<FingerFollower>(watched, sources, T_world_array, anchor, stop, clock);
  }
  const sensing::Rig rig = load_posed_rig(frames.rig).rig;
  const Transform T_array_joints = glm::inverse(T_world_array) * rig.T_world_joints.value_or(Transform(1.0));
  return std::make_unique<JointFollower>(on, sensing::open_tracker(session::parse_spec(frames.source).argument, true),
                                         T_array_joints, anchor, stop, clock);
}

}  // namespace palpa::setup
