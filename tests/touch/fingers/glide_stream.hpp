// Frames of points through a stage that follows fingers.
#pragma once

#include <cstdint>
#include <vector>

#include "touch/harness.hpp"

namespace palpa::touch::test {

inline constexpr double frame_90 = 1.0 / 90;

/// Frames of points through a stage that follows fingers.
class Stream {
 public:
  Stream(const std::vector<geometry::Solid>& solids, const StageSetting& setting) : stage_(solids, {}, setting) {}
  const Touch& frame(const std::vector<glm::vec3>& points, double time_s) {
    stage_.touch(indexed(points), touch_, time_s);
    return touch_;
  }
  void set_pose(const Transform& T_world_rest) { stage_.set_pose(0, T_world_rest); }

 private:
  Stage stage_;
  Touch touch_;
};

inline StageSetting setting_of(std::uint32_t foci, Smoothing smoothing, Axes axes = Axes::steady) {
  // Few contacts, far apart.
  return {.parameters = {.finger_gap_m = 0.02, .foci = foci}, .follow = true, .axes = axes, .smoothing = smoothing};
}

}  // namespace palpa::touch::test
