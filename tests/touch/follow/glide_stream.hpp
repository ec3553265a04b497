// Frames of points through a stage that follows fingers, and the motion of their foci.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <vector>

#include "touch/harness.hpp"

namespace palpa::touch::test {

inline constexpr double frame_90 = 1.0 / 90;

/// Frames of points through a stage that follows fingers.
class Stream {
 public:
  Stream(Backend backend, const std::vector<geometry::Solid>& solids, const StageSetting& setting) {
    backend == Backend::cpu ? void(host_.emplace(solids, std::span<const sensing::Camera>(), setting))
                            : void(device_.emplace(solids, std::span<const sensing::Camera>(), setting));
  }
  const Touch& frame(const std::vector<glm::vec3>& points, double time_s) {
    const auto skin = indexed(points);
    host_ ? host_->touch(skin, touch_, time_s) : device_->touch(skin, touch_, time_s);
    return touch_;
  }
  void set_pose(const Transform& T_world_rest) {
    host_ ? host_->set_pose(0, T_world_rest) : device_->stage.set_pose(0, T_world_rest);
  }

 private:
  std::optional<HostStage> host_;
  std::optional<DeviceStage> device_;
  Touch touch_;
};

inline StageSetting setting_of(std::uint32_t foci, Smoothing smoothing, Axes axes = Axes::steady) {
  // Few contacts, far apart.
  return {.parameters = {.finger_gap_m = 0.02, .foci = foci}, .follow = true, .axes = axes, .smoothing = smoothing};
}

/// For the focus that moves most, relative to the foci's mean.
inline double step_between(const Finger& a, const Finger& b) {
  Vec3 mean(0);
  for (std::size_t n = 0; n < a.foci.size(); ++n)
    mean += Vec3(b.foci[n].position - a.foci[n].position) / static_cast<double>(a.foci.size());
  double most = 0;
  for (std::size_t n = 0; n < a.foci.size(); ++n)
    most = std::max(most, glm::length(Vec3(b.foci[n].position - a.foci[n].position) - mean));
  return most;
}

}  // namespace palpa::touch::test
