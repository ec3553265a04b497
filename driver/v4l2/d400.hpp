// What a RealSense D400 says and takes through the extension unit of its depth interface: requests of UVC, wrapped by
// the kernel's driver. The layouts are those that librealsense uses (src/ds/ds-private.h, src/hw-monitor.cpp,
// src/ds/ds-options.cpp, src/ds/d400/d400-private.cpp).
//
// Tried on made-up cameras that answer as librealsense expects it, and on no device yet.
#pragma once

#include <cstdint>

#include "driver/cameras/device.hpp"
#include "driver/v4l2/kernel.hpp"

namespace palpa::driver::v4l2::d400 {

/// Whether it is worth asking: Intel's, on USB.
bool is_realsense(const Node& node);

// All throw failure(): what was asked, and what the camera or the kernel answered.

/// Metres per step of depth.
double read_depth_unit(Kernel& kernel, int fd);
/// Whole micrometres. It holds until the camera loses power. Does not look whether it was taken.
void write_depth_unit(Kernel& kernel, int fd, double metres);
/// Of the rectified depth image, whose distortion is none, from the calibration that the camera keeps. Refuses a table
/// whose checksum is wrong and a size that is not in it.
cameras::Lens read_lens(Kernel& kernel, int fd, std::uint32_t width, std::uint32_t height);
/// 0: the camera's own automatic.
void write_exposure(Kernel& kernel, int fd, double seconds);
/// librealsense's option "hardware preset".
void write_hardware_preset(Kernel& kernel, int fd, std::uint8_t preset);

}  // namespace palpa::driver::v4l2::d400
