#include "driver/rosbag/messages.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "driver/rosbag/cursor.hpp"

namespace palpa::driver::rosbag {
namespace {

constexpr std::uint32_t most_side = 4096;

/// std_msgs/Header: a number, a time, a frame of reference.
void skip_header(Cursor& cursor) {
  cursor.take<std::uint32_t>();
  cursor.take<std::uint64_t>();
  cursor.text();
}

void check_size(std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0 || width > most_side || height > most_side)
    throw Malformed(
        fmt::format("an image has {}x{} pixels; palpa takes at most {} on a side", width, height, most_side));
}

double within(double value, double low, double high, const char* name) {
  if (!(value >= low && value <= high))
    throw Malformed(fmt::format("the camera's {} is {:.4g}, not {:g} to {:g}", name, value, low, high));
  return value;
}

}  // namespace

void read_camera_info(std::span<const std::uint8_t> message, sensing::Camera& camera) {
  Cursor cursor(message);
  skip_header(cursor);
  camera.height = cursor.take<std::uint32_t>();
  camera.width = cursor.take<std::uint32_t>();
  check_size(camera.width, camera.height);
  const std::string model(cursor.text());
  const auto coefficients = cursor.take<std::uint32_t>();
  camera.distortion = {};
  bool distorts = false;
  for (std::uint32_t i = 0; i < coefficients; ++i) {
    const double value = within(cursor.take<double>(), -1e3, 1e3, "distortion");
    distorts = distorts || value != 0;
    if (i < camera.distortion.size()) camera.distortion[i] = value;
    if (i >= camera.distortion.size() && value != 0)
      throw Malformed(fmt::format("a lens has {} coefficients; palpa knows k1 k2 p1 p2 k3", coefficients));
  }
  if (distorts && model != "Brown Conrady" && model != "plumb_bob")
    throw Malformed(fmt::format("the lens model is '{}'; palpa knows Brown Conrady's", model));
  double k[9];
  for (double& value : k)
    value = cursor.take<double>();
  camera.fx = within(k[0], 1e-3, 1e7, "focal length");
  camera.fy = within(k[4], 1e-3, 1e7, "focal length");
  camera.cx = within(k[2], -1e6, 1e6, "centre");
  camera.cy = within(k[5], -1e6, 1e6, "centre");
  if (distorts && sensing::find_blind_pixel(camera))
    throw Malformed("the lens distortion cannot be undone in all of the image");
}

float read_float(std::span<const std::uint8_t> message) {
  return Cursor(message).take<float>();
}

std::uint32_t read_rate(std::span<const std::uint8_t> message) {
  const auto rate = Cursor(message).take<std::uint32_t>();
  if (rate > 1000)
    throw Malformed(fmt::format("the camera gives {} frames per second; palpa takes at most 1000", rate));
  return rate;
}

DepthImage read_depth_image(std::span<const std::uint8_t> message) {
  Cursor cursor(message);
  skip_header(cursor);
  DepthImage image;
  image.height = cursor.take<std::uint32_t>();
  image.width = cursor.take<std::uint32_t>();
  check_size(image.width, image.height);
  const std::string encoding(cursor.text());
  if (encoding != "mono16" && encoding != "16UC1")
    throw Malformed(fmt::format("depth has the encoding '{}'; palpa knows mono16 and 16UC1", encoding));
  if (cursor.take<std::uint8_t>() != 0)
    throw Malformed("depth has the high byte first; palpa reads the low byte first");
  image.step = cursor.take<std::uint32_t>();
  image.rows = cursor.counted();
  if (image.step < image.width * 2 || image.rows.size() < std::uint64_t{image.step} * image.height)
    throw Malformed(
        fmt::format("a depth image of {}x{} has only {} bytes", image.width, image.height, image.rows.size()));
  return image;
}

}  // namespace palpa::driver::rosbag
