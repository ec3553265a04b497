#include "driver/rosbag/messages.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <span>

#include "base/files/lines.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "driver/rosbag/cursor.hpp"
#include "sensing/grey_png.hpp"

namespace palpa::driver::rosbag {
namespace {

constexpr std::uint32_t most_side = 4096;
constexpr std::string_view png_part = "/image/data/compressedDepth";

bool is_depth(std::string_view topic) {
  return topic.substr(sensor_of(topic).size()).starts_with("/Depth_");
}

/// At the message's first value.
Cursor values_of(const Message& message) {
  if (message.encoding == Encoding::ros) return Cursor(message.data);
  // CDR begins with two bytes that say which of its forms it has, and two that say nothing.
  constexpr std::uint8_t zstd[] = {0x28, 0xb5, 0x2f, 0xfd}, little_endian[] = {0, 1};
  const auto begins = [&](std::span<const std::uint8_t> bytes) {
    return message.data.size() >= 4 && std::ranges::equal(message.data.first(bytes.size()), bytes);
  };
  if (begins(zstd))
    throw Malformed("it is compressed with zstd, which palpa does not read: record without compression");
  if (!begins(little_endian)) throw Malformed("it is not in little-endian CDR");
  return Cursor(message.data.subspan(4), true);
}

/// std_msgs/Header: a number (of ROS only), a time, a frame of reference.
void skip_header(Cursor& cursor, Encoding encoding) {
  if (encoding == Encoding::ros) cursor.take<std::uint32_t>();
  cursor.take<std::uint32_t>();
  cursor.take<std::uint32_t>();
  cursor.text();
}

/// A text of ROS 2 as a number, or, by the names before it, several: "encoding=Z16;fps=30".
class Fields {
 public:
  explicit Fields(const Message& message) : text_(values_of(message).text()) {}

  std::string_view text(std::string_view name) const {
    for (const std::string_view field : cells_of(text_, ';')) {
      const std::size_t equals = field.find('=');
      if (field.substr(0, equals) == name && equals != std::string_view::npos) return field.substr(equals + 1);
    }
    throw Malformed(fmt::format("'{}' has no {}", printable(text_, 100), name));
  }
  double number(std::string_view name) const { return number_in(text(name), name); }
  double number() const { return number_in(text_, "value"); }

  static double number_in(std::string_view text, std::string_view name) {
    const auto value = parse_number(text);
    if (!value) throw Malformed(fmt::format("the {} is '{}', which is no number", name, printable(text, 60)));
    return *value;
  }

 private:
  std::string_view text_;
};

double within(double value, double low, double high, const char* name) {
  if (!(value >= low && value <= high))
    throw Malformed(fmt::format("the {} is {:.4g}, not {:g} to {:g}", name, value, low, high));
  return value;
}

void check_size(double width, double height) {
  const auto good = [](double side) { return side >= 1 && side <= most_side && side == std::floor(side); };
  if (!good(width) || !good(height))
    throw Malformed(
        fmt::format("an image has {}x{} pixels; palpa takes at most {} on a side", width, height, most_side));
}

void set_lens(sensing::Camera& camera, std::span<const double> coefficients, std::string_view model, double fx,
              double fy, double cx, double cy) {
  camera.distortion = {};
  bool distorts = false;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const double value = within(coefficients[i], -1e3, 1e3, "camera's distortion");
    distorts = distorts || value != 0;
    if (i < camera.distortion.size()) camera.distortion[i] = value;
    if (i >= camera.distortion.size() && value != 0)
      throw Malformed(fmt::format("a lens has {} coefficients; palpa knows k1 k2 p1 p2 k3", coefficients.size()));
  }
  if (distorts && model != "Brown Conrady" && model != "plumb_bob")
    throw Malformed(fmt::format("the lens model is '{}'; palpa knows Brown Conrady's", printable(model, 60)));
  camera.fx = within(fx, 1e-3, 1e7, "camera's focal length");
  camera.fy = within(fy, 1e-3, 1e7, "camera's focal length");
  camera.cx = within(cx, -1e6, 1e6, "camera's centre");
  camera.cy = within(cy, -1e6, 1e6, "camera's centre");
  if (distorts && sensing::find_blind_pixel(camera))
    throw Malformed("the lens distortion cannot be undone in all of the image");
}

/// sensor_msgs/CameraInfo.
void read_camera_info(const Message& message, sensing::Camera& camera) {
  constexpr std::uint32_t most_coefficients = 100;
  Cursor cursor = values_of(message);
  skip_header(cursor, message.encoding);
  camera.height = cursor.take<std::uint32_t>();
  camera.width = cursor.take<std::uint32_t>();
  check_size(camera.width, camera.height);
  const std::string_view model = cursor.text();
  const auto count = cursor.take<std::uint32_t>();
  if (count > most_coefficients) throw Malformed(fmt::format("a lens has {} coefficients", count));
  std::vector<double> coefficients;
  for (std::uint32_t i = 0; i < count; ++i)
    coefficients.push_back(cursor.take<double>());
  double k[9];
  for (double& value : k)
    value = cursor.take<double>();
  set_lens(camera, coefficients, model, k[0], k[4], k[2], k[5]);
}

void read_camera_text(const Message& message, sensing::Camera& camera) {
  const Fields fields(message);
  const double width = fields.number("width"), height = fields.number("height");
  check_size(width, height);
  camera.width = static_cast<std::uint32_t>(width);
  camera.height = static_cast<std::uint32_t>(height);
  constexpr std::size_t most_coefficients = 100;
  std::vector<double> coefficients;
  for (const std::string_view cell : cells_of(fields.text("coeffs"), ',')) {
    if (coefficients.size() == most_coefficients) throw Malformed("a lens has more than 100 coefficients");
    coefficients.push_back(Fields::number_in(cell, "coeffs"));
  }
  set_lens(camera, coefficients, fields.text("model"), fields.number("fx"), fields.number("fy"), fields.number("ppx"),
           fields.number("ppy"));
}

void refuse_other_size(double width, double height, const sensing::Camera& camera) {
  if (width == camera.width && height == camera.height) return;
  throw Malformed(
      fmt::format("an image has {}x{} pixels, but its camera has {}x{}", width, height, camera.width, camera.height));
}

/// sensor_msgs/Image of 16 bits per pixel.
void read_plain_image(const Message& message, const sensing::Camera& camera, std::vector<std::uint16_t>& depth) {
  Cursor cursor = values_of(message);
  skip_header(cursor, message.encoding);
  const auto height = cursor.take<std::uint32_t>(), width = cursor.take<std::uint32_t>();
  check_size(width, height);
  const std::string_view encoding = cursor.text();
  if (encoding != "mono16" && encoding != "16UC1")
    throw Malformed(fmt::format("depth has the encoding '{}'; palpa knows mono16 and 16UC1", printable(encoding, 60)));
  if (cursor.take<std::uint8_t>() != 0)
    throw Malformed("depth has the high byte first; palpa reads the low byte first");
  const auto step = cursor.take<std::uint32_t>();
  const std::span<const std::uint8_t> rows = cursor.counted();
  if (step < width * 2 || rows.size() < std::uint64_t{step} * height)
    throw Malformed(fmt::format("a depth image of {}x{} has only {} bytes", width, height, rows.size()));
  refuse_other_size(width, height, camera);
  depth.resize(sensing::pixel_count(camera));
  for (std::uint32_t v = 0; v < height; ++v)
    std::memcpy(depth.data() + std::size_t{v} * width, rows.data() + std::size_t{v} * step, std::size_t{width} * 2);
}

/// sensor_msgs/CompressedImage as image_transport's compressedDepth has it: a PNG after 12 bytes that are of use only
/// for depths that are no whole numbers.
void read_png_image(const Message& message, const sensing::Camera& camera, std::vector<std::uint16_t>& depth) {
  constexpr std::size_t before = 12;
  Cursor cursor = values_of(message);
  skip_header(cursor, message.encoding);
  const std::string_view format = cursor.text();
  if (format != "16UC1; compressedDepth png" && format != "16UC1; compressedDepth")
    throw Malformed(
        fmt::format("depth has the format '{}'; palpa knows 16UC1; compressedDepth png", printable(format, 60)));
  Cursor data(cursor.counted());
  data.bytes(before);
  const std::string fault =
      sensing::decode_png16(Cursor::as_text(data.bytes(data.left())), camera.width, camera.height, depth);
  if (!fault.empty()) throw Malformed("its image " + fault);
}

}  // namespace

std::string sensor_of(std::string_view topic) {
  std::size_t end = topic.find('/', 1);
  if (end != std::string_view::npos) end = topic.find('/', end + 1);
  return std::string(topic.substr(0, end));
}

Says says_of(std::string_view topic) {
  // Since 2.20, librealsense writes option names with underscores; before that, as they are.
  if (topic.ends_with("/option/Depth_Units/value") || topic.ends_with("/option/Depth Units/value")) return Says::unit;
  if (!is_depth(topic)) return Says::nothing;
  if (topic.ends_with("/camera_info")) return Says::lens;
  if (topic.ends_with("/info")) return Says::rate;
  return topic.ends_with("/image/data") || topic.ends_with(png_part) ? Says::image : Says::nothing;
}

Says says_of(std::string_view topic, std::string_view type) {
  const Says says = says_of(topic);
  const std::string_view wanted = topic.ends_with("/image/camera_info") ? camera_info_type
                                  : topic.ends_with(png_part)           ? "sensor_msgs/msg/CompressedImage"
                                  : says == Says::image                 ? "sensor_msgs/msg/Image"
                                                                        : "std_msgs/msg/String";
  return type == wanted ? says : Says::nothing;
}

void read_lens(const Message& message, sensing::Camera& camera) {
  const bool text = message.encoding == Encoding::cdr && !message.topic->ends_with("/image/camera_info");
  text ? read_camera_text(message, camera) : read_camera_info(message, camera);
}

double read_unit_m(const Message& message) {
  const double unit_m = message.encoding == Encoding::cdr ? Fields(message).number()
                                                          : static_cast<double>(values_of(message).take<float>());
  within(unit_m, 1e-9, 1, "depth unit in metres");
  // A bag has it as a float: 0.0001f is meant to be 0.0001.
  return std::round(unit_m * 1e9) * 1e-9;
}

double read_rate(const Message& message) {
  const double rate =
      message.encoding == Encoding::cdr ? Fields(message).number("fps") : values_of(message).take<std::uint32_t>();
  if (!(rate >= 0 && rate <= 1000))
    throw Malformed(fmt::format("the camera gives {} frames per second; palpa takes at most 1000", rate));
  return rate;
}

void read_image(const Message& message, const sensing::Camera& camera, std::vector<std::uint16_t>& depth) {
  message.topic->ends_with(png_part) ? read_png_image(message, camera, depth)
                                     : read_plain_image(message, camera, depth);
}

}  // namespace palpa::driver::rosbag
