// The sources of depth frames: a synthetic rig, a recording, later real cameras. Interchangeable by name.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensing/rig.hpp"

namespace palpa::sensing {

/// One camera's 16-bit image, rows from the top, values in the camera's depth unit, 0 = no data.
struct DepthFrame {
  std::vector<std::uint16_t> depth;  ///< width * height of the camera with the same index
  double time_s = 0;                 ///< capture time on the source's clock
};

/// One frame of every camera of a rig, in the rig's order, taken together.
struct FrameSet {
  std::vector<DepthFrame> frames;
  double time_s = 0;           ///< the oldest capture time of the frames
  std::uint64_t sequence = 0;  ///< counts from 0; gaps are frames that the source dropped
};

class DepthSource {
 public:
  virtual ~DepthSource() = default;
  /// Constant during the source's lifetime.
  virtual const std::vector<Camera>& cameras() const = 0;
  /// Blocks until the next set is available, at most about `timeout_s`. Reuses `out`'s storage. Returns false at the
  /// end of the stream. If no set comes in time, `out.frames` is empty and the result is true. Throws Error on a fault.
  virtual bool next(FrameSet& out, double timeout_s) = 0;
};

}  // namespace palpa::sensing
