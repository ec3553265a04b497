// The sources of frames: a synthetic rig, a recording, real cameras, a tracker of hands, another program.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensing/joints/capsules.hpp"
#include "sensing/rig.hpp"
#include "sensing/skin_point.hpp"

namespace palpa::sensing {

/// One camera's 16-bit image, rows from the top, values in the camera's depth unit, 0 = no data.
struct DepthFrame {
  std::vector<std::uint16_t> depth;  ///< width * height of the camera with the same index
  double time_s = 0;                 ///< capture time on the source's clock
};

/// One frame of every camera of a rig, in the rig's order, taken together; or one of a tracker of hands; or points of
/// another program.
struct FrameSet {
  std::vector<DepthFrame> frames;
  std::vector<Capsule> capsules;  ///< of a tracker: the bones of the hands that it sees, world
  bool tracked = false;           ///< of a tracker, which may see no hand; there are no images
  std::vector<SkinPoint> points;  ///< of a program that knows where skin is, world; indices ascend
  bool pushed = false;            ///< of such a program, which may see no skin
  bool in_doubt = false;          ///< of a tracker: hands were left out because they may be wrong
  double time_s = 0;              ///< the oldest capture time of the frames
  std::uint64_t sequence = 0;     ///< counts from 0; gaps are frames that the source dropped

  /// Whether there is a frame.
  bool came() const { return tracked || pushed || !frames.empty(); }
};

class DepthSource {
 public:
  virtual ~DepthSource() = default;
  /// Constant during the source's lifetime. None: it is a tracker or a program that
  /// pushes points.
  virtual const std::vector<Camera>& cameras() const = 0;
  /// Blocks until the next set is available, at most about `timeout_s`. Reuses `out`'s storage. Returns false at the
  /// end of the stream. If no set comes in time, there is no frame and the result is true. Throws Error on a fault.
  virtual bool next(FrameSet& out, double timeout_s) = 0;
};

}  // namespace palpa::sensing
