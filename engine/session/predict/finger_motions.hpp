// The motion of each finger, followed by its number from frame to frame.
#pragma once

#include <cstdint>
#include <vector>

#include "session/predict/kept_frames.hpp"
#include "session/predict/motion_filter.hpp"
#include "session/predict/skin_step.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// Two frames of images around fingers, of one view: this one and the one before it.
struct FramePair {
  const CameraView& view;
  const KeptFrames &now, &before;
};

/// A finger's place is where its contacts' centroid was when it was first seen, plus the steps of its skin since then
/// (skin_step.hpp). Without images, it is the centroid itself. Allocates nothing once the scratch memory has grown.
class FingerMotions {
 public:
  FingerMotions();

  /// The fingers of the next frame, captured at `time_s`. Fingers that are missing are forgotten. A finger restarts if
  /// its cross-section suddenly has another size, because another finger has joined or left it.
  void see(const touch::Touch& touch, double time_s, const FramePair* frames);
  std::uint32_t count() const { return count_; }
  /// The gated velocity of the frame's finger `f`, m/s.
  Vec3 velocity(std::uint32_t f) const { return known_[f].filter.velocity(); }
  /// The box around its contacts.
  const Box& box(std::uint32_t f) const { return known_[f].box; }

 private:
  struct Known {
    std::uint32_t id = 0;
    MotionFilter filter;
    double time_s = 0;
    Vec3 centroid{0}, place{0};
    double spread_m2 = 0;  ///< the first eigenvalue of its cross-section
    Box box;
  };
  void go_on(Known& known, const touch::Finger& finger, double time_s, const FramePair* frames, bool tracked);

  std::vector<Known> known_, before_;  ///< in the order of the frame's fingers
  std::uint32_t count_ = 0;
  SkinScratch scratch_;
};

}  // namespace palpa::session
