// Makes a camera ready: opened, set up as the rig says if it is a RealSense, and streaming.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "driver/v4l2/d400.hpp"
#include "driver/v4l2/kernel.hpp"
#include "driver/v4l2/stream.hpp"
#include "sensing/camera.hpp"

namespace palpa::driver::v4l2 {

/// What the command line and the rig say about a camera.
struct Description {
  std::string name;  ///< the rig's
  std::string path;  ///< as on the command line
  Wanted wanted;
  std::string rig;  ///< its file, for messages
  double depth_unit_m = 0.001;
  sensing::DeviceSetting setting{};
};

/// What a camera has reported about itself. One that comes back must report the same.
struct Known {
  std::optional<cameras::Lens> lens;  ///< of its own calibration, if the setting asks for that
  bool unit_read = false;             ///< after that, a camera that does not answer is not trusted
  bool trusted_said = false;
};

/// `node` is what sysfs knows of `path`. Throws bad_input as Stream does, if the camera keeps another depth unit than
/// the rig says or cannot keep that one, and if its lens is not the known one. May take seconds if the device does not
/// answer.
std::unique_ptr<Stream> open_camera(Kernel& kernel, const Description& description, const std::string& path,
                                    const Node& node, Known& known);

}  // namespace palpa::driver::v4l2
