// An image of everything that stands still before a depth camera, made from several frames: less noise than a single
// frame, and nothing that moves.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "sensing/camera.hpp"

namespace palpa::sensing {

/// A camera's pixels as points in the camera frame, rows from the top; z = 0 if a pixel has no point.
struct StillImage {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec3> points;      ///< metres
  std::uint64_t seen = 0;             ///< the number of points
  std::uint64_t deep = 0;             ///< pixels that have a depth in any frame, also where something moves
  std::size_t frames = 0;             ///< number of frames that it was made of,
  std::uint64_t first = 0, last = 0;  ///< and their first and last number

  const glm::vec3& at(std::uint32_t u, std::uint32_t v) const { return points[std::size_t{v} * width + u]; }
};

class StillFrames {
 public:
  /// All pixels count, also those that `camera` ignores because they are not skin.
  explicit StillFrames(const Camera& camera) : camera_(camera) {}

  /// One frame's raw depths, width * height of them. Without a number, it is the next one.
  void add(std::span<const std::uint16_t> depth, std::optional<std::uint64_t> number = {});
  std::size_t frames() const { return frames_.size(); }
  /// For each pixel, the mean of the middle half of its depths. No point if half of the frames or more have no data, if
  /// the depths differ too much for something that stands still, and beside a step in depth, where cameras invent
  /// points.
  StillImage finish() const;

 private:
  Camera camera_;
  std::vector<std::vector<std::uint16_t>> frames_;
  std::uint64_t first_ = 0, last_ = 0;
};

}  // namespace palpa::sensing
