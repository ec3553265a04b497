// Moves fingers to where they will be when their foci sound. The rules are in docs/touch-frames.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "array/schedule.hpp"
#include "base/math.hpp"
#include "session/predict/kept_frames.hpp"
#include "session/predict/motion_filter.hpp"
#include "session/predict/prediction.hpp"
#include "session/predict/second_search.hpp"
#include "session/predict/skin_step.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// Two frames of images around fingers, of one view: this one and the one before it.
struct FramePair {
  const CameraView& view;
  const KeptFrames &now, &before;
};

/// The motion of each finger, followed by its number from frame to frame.
///
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

/// The times for which a plan's foci are predicted.
struct Ahead {
  double foci_s = 0;  ///< from capture to the middle of the first cycle: where foci are sought
  array::Advance advance;
  bool clamped = false;
};

/// `cycle`: the number of slots in which a finger's foci usually play once. Without a first slot that is known, foci
/// stand still in the middle of the cycle.
Ahead ahead_of(const std::optional<FirstSlot>& first, double latency_s, std::uint32_t cycle, double slot_s);

/// What a predictor needs of a session; what is referred to must outlive it.
struct PredictorSetting {
  PredictOptions options;
  CameraView view;
  const touch::PreparedSolids& solids;  ///< in their current poses
  touch::FingerOptions parameters;
  std::uint32_t cycle = 10;  ///< slots
  double slot_s = 1.5e-3;
};

/// For each frame: keep() when it comes, see() when its fingers are known, advance() when their schedule is made. Never
/// adds a finger or a focus.
class Predictor {
 public:
  explicit Predictor(const PredictorSetting& setting);

  /// One for each frame in flight.
  KeptFrames make_kept() const { return KeptFrames(setting_.view); }
  /// Keeps the images around the fingers that were seen last.
  void keep(std::span<const sensing::DepthFrame> images, KeptFrames& kept);
  void set_pixel_stride(std::uint32_t stride) { search_.set_pixel_stride(stride); }

  /// The fingers of a frame, as they will be at the middle of their foci's first cycle; those that no longer touch are
  /// left out. It is `seen` itself if nothing moves, or if neither the first slot nor a latency is known. `kept` is
  /// swapped for one that may be used again. Valid until the next call.
  const touch::Touch& see(const touch::Touch& seen, double time_s, const std::optional<FirstSlot>& first,
                          KeptFrames& kept);
  /// Gives the voices of that touch, in the order of its fingers, the velocity that takes each slot's foci from there
  /// to the slot's own time. Returns the result of the prediction; nothing without a finger that was seen or a latency.
  std::optional<Prediction> advance(array::Schedule& schedule) const;

 private:
  PredictorSetting setting_;
  FingerMotions motions_;
  SecondSearch search_;
  KeptFrames before_;
  std::vector<Box> boxes_;
  touch::Touch ahead_;
  // The newest frame.
  Ahead times_;
  std::optional<Prediction> made_;
  std::array<Vec3, touch::max_fingers> velocity_{};  ///< of the fingers of the result
  bool moves_ = false;
};

}  // namespace palpa::session
