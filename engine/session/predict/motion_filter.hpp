// Where a point that moves with a finger will be some milliseconds after it was seen: a Kalman filter for constant
// velocity, with a gate for the velocity. docs/notes/prediction-errors.md says what it gains and why other filters were
// not taken.
//
// Each axis has the state (x, v). Between two frames, white acceleration of the spectral density a q^2 acts on it:
//
//   x += v dt,  P += a q^2 (dt^3 / 3, dt^2 / 2; dt^2 / 2, dt),  and then the measurement z with the variance sigma^2
//
// The three axes have the same P. For cameras, a is 1. For trackers, it falls, down to 0.02, while z is where it is
// expected, so that slow motion that is even is known exactly. It is 1 as soon as z is elsewhere. The point is
// predicted for `ahead_s` after the newest frame as
//
//   x + (1 - 0.1 a) g ahead_s v,  g = |v|^n / (|v|^n + v0^n),  v0^2 = 12 P_vv,  n = 4, for trackers 8
//
// so a velocity that could be noise predicts nothing: v0^2 is four times the variance of the speed, 3 P_vv. The filter
// knows this variance itself, so the gate follows the rate of the frames and the noise without a setting. The factor
// 0.9 bounds the error when a finger turns back.
#pragma once

#include "base/math.hpp"

namespace palpa::session {

class MotionFilter {
 public:
  /// After a longer pause the filter restarts, because a finger turns back in less.
  static constexpr double longest_pause_s = 0.1;

  /// `noise_m` is sigma of each coordinate; at least 0.1 mm is assumed.
  explicit MotionFilter(double noise_m = 0.3e-3);

  /// The place in metres, seen at `time_s`. Restarts if the time goes back, or after a pause. Another place at the time
  /// of the last one improves the place and the velocity no more than a second measurement can.
  /// `tracked`: by a tracker, whose places are smooth, so slow motion is predicted by the whole of its way.
  void see(double time_s, const Vec3& place_m, bool tracked = false);
  /// Forgets everything.
  void restart() { known_ = false; }

  /// The gated velocity in m/s, at most most_speed. Zero before the second frame.
  Vec3 velocity() const;
  /// The filtered place.
  const Vec3& place() const { return place_; }
  /// The place `ahead_s` after the newest frame.
  Vec3 at(double ahead_s) const { return place_ + velocity() * ahead_s; }

  static constexpr double most_speed = 3;  ///< m/s; no hand on an object is faster

 private:
  void accelerate(double density, double dt);

  double sigma2_;
  bool known_ = false;
  double time_s_ = 0;
  Vec3 place_{0}, velocity_{0};
  double pxx_ = 0, pxv_ = 0, pvv_ = 0;
  double share_ = 1;  ///< a
  bool tracked_ = false;
};

}  // namespace palpa::session
