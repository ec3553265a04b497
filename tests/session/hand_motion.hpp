// The shared recordings of fingertips (hand-motion), as places over time, and the errors of a prediction on them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/math.hpp"

namespace palpa::test {

/// The text of a file that gzip has packed; empty if there is none.
std::string unpacked(const std::filesystem::path& file);

/// One fingertip of one recording.
struct TipPath {
  std::string name;
  std::vector<double> time_s;  ///< ascends strictly
  std::vector<Vec3> place_m;
  bool faithful = false;  ///< markers: the places are the truth. False: a tracker's, which has filtered them

  double begin_s() const { return time_s.front(); }
  double end_s() const { return time_s.back(); }
  /// Linear between two frames.
  Vec3 at(double time_s) const;
  Vec3 velocity_at(double time_s, double over_s) const;
  /// Every n-th frame.
  TipPath thinned(std::size_t n) const;
};

/// The tip of the finger that moves in each of the marker trials, and a neighbour's; all tips of the Leap recordings
/// without lost frames. Empty without the shared data.
std::vector<TipPath> marker_tips();
std::vector<TipPath> leap_tips();

/// A predictor of one path: gets the frames in order, and is asked for the place after the newest.
struct TipPredictor {
  std::function<void(double time_s, const Vec3& place_m)> see;
  std::function<Vec3(double ahead_s)> at;
};

/// Root mean squares of the error, relative to those of the newest place that was seen.
struct PredictionError {
  double move = 0;    ///< faster than 100 mm/s
  double rest = 0;    ///< slower than 30 mm/s within 100 ms before and after
  double turn = 0;    ///< the velocity turns by more than 90 degrees within the horizon and 30 ms around it
  double median = 0;  ///< while it moves: of the errors themselves
  std::size_t moves = 0, rests = 0, turns = 0;
};

/// For all `paths`, with white noise of this standard deviation on each coordinate of what the predictor sees.
PredictionError error_of(const std::vector<TipPath>& paths, const std::function<TipPredictor()>& make, double ahead_s,
                         double noise_m);

}  // namespace palpa::test
