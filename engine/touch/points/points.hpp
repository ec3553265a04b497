// Skin in the shells of solids, in clusters: the part of touching that is parallel over thousands of points.
// DevicePoints finds them with kernels, HostPoints with the kernels' twins. Everything about fingers comes after it
// (fingers/fingers.hpp).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/math.hpp"
#include "gpu/pass_time.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_point.hpp"
#include "shaders/sensing/skin.h"
#include "touch/contacts/finger_reach.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// One frame of skin, and how to look at it.
struct Skin {
  std::span<const sensing::DepthFrame> images{};  ///< with cameras: one image per camera
  Box box{};                                      ///< skin is looked for in this box of the world
  std::span<const sensing::Crop> crops{};         ///< the parts of the images that show the box
  std::span<const shader::SkinVolume> volumes{};  ///< volumes in which points are not skin
  std::span<const sensing::SkinPoint> points{};   ///< without cameras: points with ascending indices
  FingerOptions parameters;
  FingerOptions clustering;  ///< the same, but smaller clusters may be fingers
  FingerReach reach{};
};

/// A frame has more points or contacts than there is room for.
class TooMuchSkin : public Error {
 public:
  explicit TooMuchSkin(const std::string& line) : Error(failure(line)) {}
};

class Points {
 public:
  virtual ~Points() = default;
  /// Starts a frame. Everything that `skin` refers to stays as it is until finish().
  virtual void start(const Skin& skin) = 0;
  /// Fills the contacts, deep points and dropped points of `out`, and solid and contacts of its fingers: the clusters.
  /// Adds the time of each part to `times`. Throws TooMuchSkin.
  virtual void finish(Touch& out, std::vector<gpu::PassTime>& times) = 0;
};

}  // namespace palpa::touch
