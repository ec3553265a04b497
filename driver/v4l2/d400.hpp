// What a RealSense D400 reports and accepts through the extension unit of its depth interface, by UVC requests that the
// kernel's driver wraps. The layouts are those that librealsense uses (src/ds/ds-private.h, src/hw-monitor.cpp,
// src/ds/ds-options.cpp, src/ds/d400/d400-private.cpp).
//
// Tested on made-up cameras that answer as librealsense expects, but on no real device yet.
#pragma once

#include <cstdint>

#include "driver/cameras/device.hpp"
#include "driver/v4l2/kernel.hpp"

namespace palpa::driver::v4l2::d400 {

/// Whether the node is worth asking: it is Intel's, on USB.
bool is_realsense(const Node& node);

// All throw failure() with what was asked and what the camera or the kernel answered.

/// Metres per step of depth.
double read_depth_unit(Kernel& kernel, int fd);
/// Writes whole micrometres. The setting holds until the camera loses power. Does not check whether it was taken.
void write_depth_unit(Kernel& kernel, int fd, double metres);
/// The lens of the rectified depth image, which has no distortion, from the calibration that the camera keeps. Refuses
/// a table whose checksum is wrong, and a size that is not in it.
cameras::Lens read_lens(Kernel& kernel, int fd, std::uint32_t width, std::uint32_t height);
/// 0: the camera's automatic exposure.
void write_exposure(Kernel& kernel, int fd, double seconds);
/// librealsense's option "hardware preset".
void write_hardware_preset(Kernel& kernel, int fd, std::uint8_t preset);

}  // namespace palpa::driver::v4l2::d400
