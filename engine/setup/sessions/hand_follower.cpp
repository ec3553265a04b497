#include "setup/sessions/hand_follower.hpp"

#include <algorithm>
#include <glm/mat4x4.hpp>
#include <optional>
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

/// A joint of a tracker's hand.
struct Joint {
  std::size_t joint;
  std::unique_ptr<sensing::Tracker> tracker;
  Transform T_array_joints;
  session::HandPlace& place;
  const session::Clock& clock;
  bool left = false;

  void follow(const std::atomic<bool>& over) {
    constexpr double look_s = 0.02;
    session::SourceClock source_clock;
    sensing::TrackedFrame frame;
    bool came = false;
    std::uint64_t number = 0;
    while (!over && tracker->next(frame, came, number, look_s)) {
      if (!came) continue;
      const double captured_s = source_clock.capture_time(frame.time_s, clock.now());
      if (frame.hands.empty()) {
        place.lose();
        continue;
      }
      const auto same = std::ranges::find(frame.hands, left, &sensing::TrackedHand::left);
      const sensing::TrackedHand& hand = same != frame.hands.end() ? *same : frame.hands.front();
      left = hand.left;
      place.see(T_array_joints * sensing::pose_of_joint(hand, joint), captured_s);
    }
  }
};

/// The finger that a session without sound finds.
struct TouchingFinger final : session::RunObserver {
  Prepared prepared;
  Transform T_array_world;
  session::HandPlace& place;
  const session::Clock& clock;
  std::unique_ptr<session::Link> silent =
      session::open_link("null", session::builtin_links(), prepared.session->link_setting());
  std::uint32_t id = 0;

  TouchingFinger(Prepared made, const Transform& T_world_array, session::HandPlace& seen, const session::Clock& times)
      : prepared(std::move(made)), T_array_world(glm::inverse(T_world_array)), place(seen), clock(times) {}

  void follow(std::atomic<bool>& over) { prepared.session->run(*prepared.source, *silent, over, {.observer = this}); }

  void planned(const session::FrameReport& report, const session::Plan&) override {
    const touch::Touch& touch = *report.touch;
    if (touch.finger_count == 0) return place.lose();
    const std::span fingers = std::span(touch.fingers).first(touch.finger_count);
    const auto same = std::ranges::find(fingers, id, &touch::Finger::id);
    const touch::Finger& finger = same != fingers.end() ? *same : fingers.front();
    id = finger.id;
    // Parallel to the array: a finger's axes are those of its contacts, and turn with every frame.
    Transform pose(1.0);
    pose[3] = Vec4(transform_point(T_array_world, Vec3(finger.section.centroid)), 1);
    place.see(pose, clock.now() - (report.planned_s - report.arrived_s));
  }
  void expired() override { place.lose(); }
};

}  // namespace

HandFollower::HandFollower(Follow follow, session::HandPlace& place, std::atomic<bool>& stop,
                           const session::Clock& clock)
    : thread_(clock.start("--on", [this, follow = std::move(follow), &place, &stop] {
        try {
          follow(over_);
        } catch (...) {
          fault_ = std::current_exception();
        }
        place.lose();
        stop = true;
      })) {}

HandFollower::~HandFollower() {
  over_ = true;
  if (thread_.joinable()) thread_.join();
}

void HandFollower::end() {
  over_ = true;
  if (thread_.joinable()) thread_.join();
  if (fault_) std::rethrow_exception(fault_);
}

HandFollower::Follow open_hand(On on, const FrameOptions& frames, std::span<const session::SourceKind> sources,
                               const Transform& T_world_array, session::HandPlace& place, const session::Clock& clock) {
  if (on == On::finger) {
    FrameOptions watched = frames;
    watched.watched = true;
    check(watched);
    const auto finger = std::make_shared<TouchingFinger>(prepare(watched, sources, true), T_world_array, place, clock);
    return [finger](std::atomic<bool>& over) { finger->follow(over); };
  }
  const sensing::Rig rig = load_posed_rig(frames.rig).rig;
  const Transform T_array_joints = glm::inverse(T_world_array) * rig.T_world_joints.value_or(Transform(1.0));
  const auto joint = std::make_shared<Joint>(
      Joint{joint_of(on), sensing::open_tracker(session::parse_spec(frames.source).argument, true), T_array_joints,
            place, clock});
  return [joint](std::atomic<bool>& over) { joint->follow(over); };
}

}  // namespace palpa::setup
