// The depth images around fingers, kept from the time when a frame comes to the time when its fingers are known.
#pragma once

#include <span>
#include <vector>

#include "base/math.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "sensing/surroundings.hpp"

namespace palpa::session {

/// The cameras of a session, the tables made from them, and what they see that is no skin; all must outlive the object
/// that has this.
struct CameraView {
  std::span<const sensing::Camera> cameras;
  const sensing::RayTables& tables;
  const sensing::Surroundings* surroundings = nullptr;  ///< null: no board, no screen, no room
};

/// Images of the cameras' size, with no data (0) except in the pixels that can show a point of one of the boxes. Copies
/// only these pixels, and allocates only when it is made.
class KeptFrames {
 public:
  KeptFrames() = default;
  explicit KeptFrames(const CameraView& view);

  /// Replaces what was kept. One image per camera; boxes in the world.
  void keep(const CameraView& view, std::span<const sensing::DepthFrame> images, std::span<const Box> boxes);
  /// Whether there is anything.
  bool any() const { return !windows_.empty(); }
  std::span<const sensing::DepthFrame> images() const { return images_; }

 private:
  std::vector<sensing::DepthFrame> images_;
  std::vector<sensing::Crop> windows_, crops_;
};

}  // namespace palpa::session
