// What the messages of a RealSense recording mean. They come in three forms: messages of ROS, messages of
// ROS 2, and texts of ROS 2. Each parser throws Malformed for a message that is not consistent.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "driver/rosbag/message.hpp"
#include "sensing/camera.hpp"

namespace palpa::driver::rosbag {

/// What a message says about a depth camera, or about a sensor that may be one.
enum class Says { nothing, unit, lens, rate, image };

/// Which of them a topic is about.
Says says_of(std::string_view topic);
/// The same of a topic of ROS 2, which must have the type that palpa reads there.
Says says_of(std::string_view topic, std::string_view type);
inline constexpr std::string_view camera_info_type = "sensor_msgs/msg/CameraInfo";

/// "/device_0/sensor_0" of "/device_0/sensor_0/Depth_0/image/data".
std::string sensor_of(std::string_view topic);

/// Reads size, focal lengths, centre and distortion of `camera`, and changes nothing else in it. Refuses a lens whose
/// distortion cannot be undone over the whole image, and distorting models other than Brown-Conrady's.
void read_lens(const Message& message, sensing::Camera& camera);

/// Metres per step of depth, 1e-9 to 1.
double read_unit_m(const Message& message);

/// Frames per second.
double read_rate(const Message& message);

/// A depth image of exactly the camera's size.
void read_image(const Message& message, const sensing::Camera& camera, std::vector<std::uint16_t>& depth);

}  // namespace palpa::driver::rosbag
