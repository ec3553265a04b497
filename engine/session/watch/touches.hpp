// The touches of fingers, from frame to frame: when each begins, presses and ends. This is the one place that decides
// it. Events report it, and what a finger feels is forgotten with the end of its touch.
//
//   begin    a finger touches a solid that it did not touch before
//   press    it passes the solid's press depth, and again only after it has come back up to press_rearm of that depth
//   end      it was missing from frames for half of the hold, or no frame came for the hold
//
// A hand that a tracker or the cameras lose while it presses has not come up. So a finger that comes back to the place
// of a press within lost_press_s does not press again, unless a frame between has shown the hand elsewhere. This time
// begins when the hand is lost; while frames come whose hands are in doubt (sensing/joints/hand_check.hpp), it does not
// pass, however long the doubt lasts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/solid.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// A finger that presses still does from this share of the press depth on.
inline constexpr double press_rearm = 0.8;
/// A finger that was lost while it pressed comes back within this time, and no farther from where it was.
inline constexpr double lost_press_s = 0.2, lost_press_m = 20e-3;

/// A finger's touch as a frame has it.
struct HeldTouch {
  std::uint32_t id = 0, solid = 0;
  double seen_s = 0;     ///< when the finger was last seen
  float depth_m = 0;     ///< then
  glm::vec3 centroid{};  ///< then
  bool begins = false;   ///< in this frame
  bool pressed = false;  ///< it is deep enough, or was and has not come up
  bool presses = false;  ///< it passes the press depth in this frame
  bool lifts = false;    ///< it comes up in this frame, after it pressed in the same touch
};

/// There are never more at one time.
inline constexpr std::size_t most_touches = 5 * std::size_t{touch::max_fingers};

struct EndedTouch {
  HeldTouch last{};  ///< as the finger was last seen
  double time_s = 0;
};

class Touches {
 public:
  /// `solids` are those of the touches; only their press depths are kept.
  explicit Touches(std::span<const geometry::Solid> solids, double hold_s = 0.1);

  /// The next frame. `hands`: how many hands it shows wherever they are, or how many of their bones; 0 for none;
  /// nothing if some were left out in doubt. If the time goes backwards, all touches end, and those of the frame begin.
  /// Allocates nothing.
  void update(const touch::Touch& touch, double time_s, std::optional<std::uint32_t> hands = 1);
  /// To be called if no frame has come for the hold after the last one.
  void expire();
  /// The end of the stream.
  void end();
  /// Fingers that press in `other`, an earlier scene's, do not press again here if they are where they were.
  void take_over(const Touches& other);

  /// The touches of the newest frame's fingers, in their order. Valid until the next call, like ended().
  std::span<const HeldTouch> held() const { return held_now_; }
  /// What has ended with the newest call, in the order of its times.
  std::span<const EndedTouch> ended() const { return ended_; }

 private:
  struct Held : HeldTouch {
    bool seen = false;        ///< in this frame
    bool elsewhere = false;   ///< a frame has shown its hand since it was last seen
    std::uint32_t hands = 1;  ///< in the frame in which it was last seen
  };
  struct LostPress {
    std::optional<std::uint32_t> solid{};  ///< nothing: that of another scene
    double since_s = 0;                    ///< its hand was there, or in doubt
    glm::vec3 centroid{};
    std::uint32_t hands = 1;
  };

  Held* held_of(std::uint32_t id);
  void end_missing(double time_s);
  void end(const Held& held, double time_s);
  void keep_press(const Held& held);
  bool take_press(const touch::Finger& finger);
  void follow(Held& held, const touch::Finger& finger, double time_s, std::uint32_t hands);

  std::vector<std::optional<double>> press_depth_m_;  ///< by solid
  double hold_s_, grace_s_;
  double last_s_ = 0;
  bool begun_ = false;
  std::vector<Held> held_;  ///< in the order of their beginnings; no id twice
  std::vector<LostPress> lost_;
  std::vector<HeldTouch> held_now_;
  std::vector<EndedTouch> ended_;
};

}  // namespace palpa::session
