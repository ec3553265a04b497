#include "driver/v4l2/d400.hpp"

#include <fmt/core.h>
#include <linux/usb/video.h>
#include <linux/uvcvideo.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "base/error.hpp"

namespace palpa::driver::v4l2::d400 {
namespace {

constexpr std::uint8_t unit = 3;
enum Selector : std::uint8_t { hardware_monitor = 1, exposure = 3, hardware_preset = 6, auto_exposure = 0xb };

// The hardware monitor: one request and one answer of 1024 bytes.
constexpr std::size_t monitor_bytes = 1024, answer_length_at = 1020, opcode_bytes = 4;
constexpr std::uint16_t monitor_magic = 0xcdab;
enum Opcode : std::uint32_t { read_calibration = 0x15, set_advanced = 0x2b, get_advanced = 0x2c };
constexpr std::uint32_t depth_table = 9;  ///< of the advanced controls: micrometres, then four that stay
constexpr std::size_t depth_table_bytes = 20;
constexpr std::uint32_t coefficients_table = 25;  ///< of the calibration
constexpr std::size_t table_header_bytes = 16, crc_at = 12, lenses_at = 256, lens_bytes = 16;

struct Size {
  std::uint32_t width, height;
};
/// In the calibration's order.
constexpr Size sizes[]{{1920, 1080}, {1280, 720}, {640, 480}, {848, 480},  {640, 360},
                       {424, 240},   {320, 240},  {480, 270}, {1280, 800}, {960, 540}};

template <typename Number>
Number number_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <typename Number>
void put_at(std::span<std::uint8_t> bytes, std::size_t at, Number value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

void query(Kernel& kernel, int fd, std::uint8_t selector, std::uint8_t kind, std::span<std::uint8_t> data,
           const char* what) {
  uvc_xu_control_query request{};
  request.unit = unit;
  request.selector = selector;
  request.query = kind;
  request.size = static_cast<__u16>(data.size());
  request.data = data.data();
  constexpr int attempts = 5;  // the camera is sometimes busy
  int result = 0;
  for (int i = 0; i < attempts; ++i) {
    result = kernel.ioctl(fd, UVCIOC_CTRL_QUERY, &request);
    if (result != -EBUSY && result != -EAGAIN && result != -EIO) break;
    kernel.poll({}, 0.02);
  }
  if (result < 0)
    throw failure(fmt::format("the camera does not {}: {}", what, std::generic_category().message(-result)));
}

/// The camera's answer to `opcode`, without the echoed opcode.
std::vector<std::uint8_t> ask(Kernel& kernel, int fd, Opcode opcode, std::uint32_t parameter,
                              std::span<const std::uint8_t> data, const char* what) {
  std::array<std::uint8_t, monitor_bytes> bytes{};
  constexpr std::size_t header = 4, fields = 5 * sizeof(std::uint32_t);
  put_at(bytes, 0, static_cast<std::uint16_t>(fields + data.size()));
  put_at(bytes, 2, monitor_magic);
  put_at<std::uint32_t>(bytes, header, opcode);
  put_at(bytes, header + 4, parameter);
  std::copy(data.begin(), data.end(), bytes.begin() + header + fields);
  query(kernel, fd, hardware_monitor, UVC_SET_CUR, bytes, what);
  bytes = {};
  query(kernel, fd, hardware_monitor, UVC_GET_CUR, bytes, what);
  const auto echo = number_at<std::uint32_t>(bytes, 0);
  if (echo != opcode)
    throw failure(fmt::format("the camera does not {}: it answers {}", what, static_cast<std::int32_t>(echo)));
  const auto length = number_at<std::uint32_t>(bytes, answer_length_at);
  if (length > answer_length_at - opcode_bytes)
    throw failure(fmt::format("the camera does not {}: its answer has {} bytes", what, length));
  return {bytes.begin() + opcode_bytes, bytes.begin() + opcode_bytes + length};
}

std::vector<std::uint8_t> read_depth_table(Kernel& kernel, int fd) {
  const char* what = "report its depth unit";
  std::vector<std::uint8_t> table = ask(kernel, fd, get_advanced, depth_table, {}, what);
  if (table.size() < depth_table_bytes)
    throw failure(fmt::format("the camera does not {}: its answer has {} bytes", what, table.size()));
  table.resize(depth_table_bytes);
  return table;
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = ~0u;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

}  // namespace

bool is_realsense(const Node& node) {
  constexpr std::uint16_t intel = 0x8086;
  return node.vendor == intel && !node.place.empty();
}

double read_depth_unit(Kernel& kernel, int fd) {
  return number_at<std::uint32_t>(read_depth_table(kernel, fd), 0) / 1e6;
}

void write_depth_unit(Kernel& kernel, int fd, double metres) {
  std::vector<std::uint8_t> table = read_depth_table(kernel, fd);
  put_at(table, 0, static_cast<std::uint32_t>(std::lround(metres * 1e6)));
  ask(kernel, fd, set_advanced, depth_table, table, "accept a depth unit");
}

cameras::Lens read_lens(Kernel& kernel, int fd, std::uint32_t width, std::uint32_t height) {
  const char* what = "report its calibration";
  const std::vector<std::uint8_t> table = ask(kernel, fd, read_calibration, coefficients_table, {}, what);
  const auto size = std::find_if(std::begin(sizes), std::end(sizes),
                                 [&](const Size& s) { return s.width == width && s.height == height; });
  if (size == std::end(sizes))
    throw failure(fmt::format("the camera's calibration has no {}x{}; give fx, fy, cx and cy", width, height));
  const std::size_t at = lenses_at + static_cast<std::size_t>(size - std::begin(sizes)) * lens_bytes;
  if (table.size() < at + lens_bytes)
    throw failure(fmt::format("the camera does not {}: its answer has {} bytes", what, table.size()));
  if (crc32(std::span(table).subspan(table_header_bytes)) != number_at<std::uint32_t>(table, crc_at))
    throw failure("the checksum of the camera's calibration is wrong");
  const auto value = [&](std::size_t i) {
    return static_cast<double>(number_at<float>(table, at + i * sizeof(float)));
  };
  const cameras::Lens lens{value(0), value(1), value(2), value(3)};
  const double most = 10.0 * width;
  if (!(lens.fx > 1 && lens.fx < most && lens.fy > 1 && lens.fy < most && std::abs(lens.cx) < most &&
        std::abs(lens.cy) < most)) {
    throw failure(fmt::format("the camera's calibration of {}x{} is empty", width, height));
  }
  return lens;
}

void write_exposure(Kernel& kernel, int fd, double seconds) {
  std::array<std::uint8_t, 1> automatic{static_cast<std::uint8_t>(seconds == 0)};
  query(kernel, fd, auto_exposure, UVC_SET_CUR, automatic, "accept an exposure");
  if (seconds == 0) return;
  std::array<std::uint8_t, 4> microseconds{};
  put_at(microseconds, 0, static_cast<std::uint32_t>(std::lround(seconds * 1e6)));
  query(kernel, fd, exposure, UVC_SET_CUR, microseconds, "accept an exposure");
}

void write_hardware_preset(Kernel& kernel, int fd, std::uint8_t preset) {
  std::array<std::uint8_t, 1> value{preset};
  query(kernel, fd, hardware_preset, UVC_SET_CUR, value, "accept a hardware preset");
}

}  // namespace palpa::driver::v4l2::d400
