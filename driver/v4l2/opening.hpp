// A camera made ready: opened, set up as the rig says where it is a RealSense, and streaming.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "driver/v4l2/d400.hpp"
#include "driver/v4l2/kernel.hpp"
#include "driver/v4l2/stream.hpp"
#include "sensing/camera.hpp"

namespace palpa::driver::v4l2 {

/// What the command line and the rig say of a camera.
struct Description {
  std::string name;  ///< the rig's
  std::string path;  ///< as on the command line
  Wanted wanted;
  std::string rig;  ///< its file, for messages
  double depth_unit_m = 0.001;
  sensing::DeviceSetting setting{};
};

/// What a camera has told of itself. One that comes back has to tell the same.
struct Known {
  std::optional<cameras::Lens> lens;  ///< of its own calibration, where the setting asks for that
  bool unit_read = false;             ///< a camera that has answered once is not trusted again
  bool trusted_said = false;
};

/// `node` is what sysfs knows of `path`. Throws bad_input as Stream does, where the camera keeps another depth unit
/// than the rig says or can keep none like it, and where its lens is not the one that is known. May take seconds where
/// the device does not answer.
std::unique_ptr<Stream> open_camera(Kernel& kernel, const Description& description, const std::string& path,
                                    const Node& node, Known& known);

}  // namespace palpa::driver::v4l2
