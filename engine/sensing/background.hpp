// Learns what a depth camera sees without a hand: the tables, stands and boards that are no skin.
//
//   background = the second percentile of a pixel's depths   (nearer than almost all of them; holes do not count)
//   noise      = the standard deviation of its depths, at a distance of z > 1 m divided by z^2
//   margin     = 3 times the noise that 98 % of the steady pixels do not exceed, at least 2 mm
//
// A pixel is unsteady if its noise is more than 6 times the median of all: it shows an edge, or something moved there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sensing/camera.hpp"

namespace palpa::sensing {

struct LearnedBackground {
  Background background;       ///< without a file
  std::uint64_t pixels = 0;    ///< with a depth in any frame
  std::uint64_t unsteady = 0;  ///< of these
  double noise_m = 0;          ///< the noise that 98 % of the steady pixels do not exceed, at 1 m or nearer
};

/// More unsteady pixels than this share mean that something moved.
inline constexpr double default_unsteady = 0.05;

class BackgroundFrames {
 public:
  /// `frames`: the maximum number of frames. All pixels count, also those that `camera` ignores. Takes 20 bytes per
  /// pixel, and 2 more for every 50 frames.
  BackgroundFrames(const Camera& camera, std::uint64_t frames);

  /// One frame's raw depths. Throws bad_usage if their number is not the camera's, or after `frames` of them.
  void add(std::span<const std::uint16_t> depth);
  std::uint64_t frames() const { return frames_; }
  LearnedBackground finish() const;

 private:
  Camera camera_;
  std::uint64_t most_frames_, frames_ = 0;
  std::size_t kept_;                    ///< how many of a pixel's nearest depths are kept
  std::vector<std::uint16_t> nearest_;  ///< kept_ per pixel, ascending
  std::vector<std::uint32_t> counts_;   ///< depths per pixel
  std::vector<std::uint64_t> sums_;     ///< of depths
  std::vector<std::uint64_t> squares_;  ///< of their squares
};

}  // namespace palpa::sensing
