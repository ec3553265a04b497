// The ROS messages that a RealSense recording is read from. Each parser throws Malformed for a message that is not
// consistent.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "sensing/camera.hpp"

namespace palpa::driver::rosbag {

/// Reads sensor_msgs/CameraInfo into size, focal lengths, centre and distortion of `camera`, and changes nothing else
/// in it. Refuses a lens whose distortion cannot be undone over the whole image, and distorting models other than
/// Brown-Conrady's.
void read_camera_info(std::span<const std::uint8_t> message, sensing::Camera& camera);

/// std_msgs/Float32.
float read_float(std::span<const std::uint8_t> message);

/// The frames per second of realsense_msgs/StreamInfo.
std::uint32_t read_rate(std::span<const std::uint8_t> message);

/// A sensor_msgs/Image of 16 bits per pixel; `rows` points into the message.
struct DepthImage {
  std::uint32_t width = 0, height = 0, step = 0;  ///< step: bytes from row to row
  std::span<const std::uint8_t> rows;
};
DepthImage read_depth_image(std::span<const std::uint8_t> message);

}  // namespace palpa::driver::rosbag
