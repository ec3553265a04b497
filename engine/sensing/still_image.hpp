// What stands still before a depth camera, from several frames: less noise than one has, and without what moves.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "sensing/camera.hpp"

namespace palpa::sensing {

/// A camera's pixels as points of its own frame, rows from the top; z = 0 where there is nothing.
struct StillImage {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec3> points;      ///< metres
  std::uint64_t seen = 0;             ///< how many there are
  std::uint64_t deep = 0;             ///< pixels that have a depth in any frame, also where something moves
  std::size_t frames = 0;             ///< that it was made of,
  std::uint64_t first = 0, last = 0;  ///< and their numbers

  const glm::vec3& at(std::uint32_t u, std::uint32_t v) const { return points[std::size_t{v} * width + u]; }
};

class StillFrames {
 public:
  /// All pixels count, also those that `camera` ignores because they are no skin.
  explicit StillFrames(const Camera& camera) : camera_(camera) {}

  /// One frame's raw depths, width * height of them; without a number it is the next one.
  void add(std::span<const std::uint16_t> depth, std::optional<std::uint64_t> number = {});
  std::size_t frames() const { return frames_.size(); }
  /// Of each pixel the mean of the middle half of its depths. Nothing where half of the frames or more have no data,
  /// where depths disagree by more than still stands (something moved), and beside a step in depth, where cameras make
  /// points up.
  StillImage finish() const;

 private:
  Camera camera_;
  std::vector<std::vector<std::uint16_t>> frames_;
  std::uint64_t first_ = 0, last_ = 0;
};

}  // namespace palpa::sensing
