// Moves fingers to where they will be when their foci sound. The rules are in docs/touch-frames.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "array/schedule.hpp"
#include "base/math.hpp"
#include "session/predict/finger_motions.hpp"
#include "session/predict/kept_frames.hpp"
#include "session/predict/prediction.hpp"
#include "session/predict/second_search.hpp"
#include "touch/types.hpp"

namespace palpa::session {

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
