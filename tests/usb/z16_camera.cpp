#include "usb/z16_camera.hpp"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <iterator>

namespace palpa::test {
namespace {

constexpr std::uint8_t streaming_endpoint = 0x82;
constexpr std::size_t payload_bytes = 16384, header_bytes = 12;

/// Sizes, and periods in units of 100 ns, as on a D435.
struct Frame {
  std::uint16_t width, height;
  std::vector<std::uint32_t> periods;
};
const Frame frames_offered[] = {{424, 240, {111111, 166666, 333333, 666666, 1666665}},
                                {848, 480, {111111, 166666, 333333, 666666, 1666665}},
                                {1280, 720, {333333, 666666, 1666665}}};
constexpr std::uint8_t usual_frame = 2;  // counted from 1

/// UVC's numbers of descriptors and controls.
enum : std::uint8_t { control_interface = 0, streaming_interface = 1 };
enum : std::uint8_t { probe_control = 1, commit_control = 2 };
constexpr std::uint8_t class_interface = 0x24;

/// The places of the values in the probe control.
constexpr std::size_t probe_bytes = 48, format_at = 2, frame_at = 3, period_at = 4, frame_size_at = 18,
                      payload_size_at = 22;

void put32(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i)
    bytes[at + i] = low(value >> 8 * i);
}

std::uint32_t get32(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= std::uint32_t{bytes[at + i]} << 8 * i;
  return value;
}

void append32(std::vector<std::uint8_t>& to, std::initializer_list<std::uint32_t> values) {
  for (const std::uint32_t value : values) {
    to.resize(to.size() + 4);
    put32(to, to.size() - 4, value);
  }
}

std::uint32_t size_of(const Frame& frame) {
  return 2u * frame.width * frame.height;
}

/// The way of a picture in the camera: from its sensor to USB.
std::vector<std::uint8_t> control_descriptors() {
  std::vector<std::uint8_t> units;
  append(units, {18, class_interface, 2, 1, 0x01, 0x02, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0});  // 1: a camera
  append(units, D400Unit::descriptor(1));
  append(units, {9, class_interface, 3, 2, 0x01, 0x01, 0, D400Unit::number, 0});  // 2: USB
  const unsigned total = 13 + static_cast<unsigned>(units.size());
  std::vector<std::uint8_t> out{13, class_interface, 1, 0x50, 0x01, low(total), high(total)};
  append32(out, {48000000});
  append(out, {1, streaming_interface});
  append(out, units);
  return out;
}

std::vector<std::uint8_t> streaming_descriptors() {
  std::vector<std::uint8_t> format{28, class_interface, 0x10, 1, std::size(frames_offered), 'Z', '1', '6', ' '};
  append(format, {0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71, 16, usual_frame, 0, 0, 0, 0, 0});
  for (const Frame& frame : frames_offered) {
    const auto number = static_cast<std::uint8_t>(&frame - frames_offered + 1);
    const auto periods = static_cast<std::uint8_t>(frame.periods.size());
    append(format, {static_cast<std::uint8_t>(26 + 4 * periods), class_interface, 0x11, number, 0, low(frame.width),
                    high(frame.width), low(frame.height), high(frame.height)});
    const auto bits_per_s = [&](std::uint32_t period) {
      return static_cast<std::uint32_t>(std::min(8e7 * size_of(frame) / period, 4e9));
    };
    append32(format, {bits_per_s(frame.periods.back()), bits_per_s(frame.periods.front()), 333333});
    format.push_back(periods);
    append32(format, {2u * frame.width});
    for (const std::uint32_t period : frame.periods)
      append32(format, {period});
  }
  const unsigned total = 14 + static_cast<unsigned>(format.size());
  std::vector<std::uint8_t> out{
      14, class_interface, 1, 1, low(total), high(total), streaming_endpoint, 0, 2, 0, 0, 0, 1, 0};
  append(out, format);
  return out;
}

}  // namespace

Z16Camera::Z16Camera(const std::string& serial) : probe_(probe_bytes) {
  descriptors_.device = {18, 1, 0x00, 0x02, 0xef, 2, 1, 64, 0x86, 0x80, 0x07, 0x0b, 0xe0, 0x50, 1, 2, 3, 1};
  descriptors_.strings = {"Intel(R) RealSense(TM) Depth Camera 435", "Intel(R) RealSense(TM) Depth Camera 435", serial};
  std::vector<std::uint8_t> parts{8, 0x0b, control_interface, 2, 0x0e, 3, 0, 2};
  append(parts, {9, 4, control_interface, 0, 0, 0x0e, 1, 0, 2});
  append(parts, control_descriptors());
  append(parts, {9, 4, streaming_interface, 0, 1, 0x0e, 2, 0, 0});
  append(parts, streaming_descriptors());
  append(parts, {7, 5, streaming_endpoint, 2, 0x00, 0x02, 0});
  const unsigned total = 9 + static_cast<unsigned>(parts.size());
  descriptors_.configuration = {9, 2, low(total), high(total), 2, 1, 0, 0x80, 90};
  append(descriptors_.configuration, parts);
  probe_[format_at] = 1;
  probe_[frame_at] = usual_frame;
  put32(probe_, period_at, 333333);
  put32(probe_, frame_size_at, size_of(frames_offered[usual_frame - 1]));
  put32(probe_, payload_size_at, payload_bytes);
}

Answer Z16Camera::control(double now_s, const ControlRequest& request, std::vector<std::uint8_t>& bytes) {
  if (low(request.index) == control_interface && high(request.index) == D400Unit::number)
    return unit.control(request, bytes);
  const std::uint8_t control = high(request.value);
  if (low(request.index) != streaming_interface || (control != probe_control && control != commit_control))
    return Answer::stalled;
  switch (request.request) {
    case get_len:
      bytes = {probe_bytes, 0};
      return Answer::done;
    case get_info:
      bytes = {3};
      return Answer::done;
    case get_cur:
    case get_min:
    case get_max:
    case get_def:
      bytes = probe_;
      bytes.resize(std::min<std::size_t>(bytes.size(), request.length));
      return Answer::done;
    case set_cur:
      break;
    default:
      return Answer::stalled;
  }
  if (bytes.size() < payload_size_at) return Answer::stalled;
  const std::uint8_t frame = bytes[frame_at];
  if (bytes[format_at] != 1 || frame < 1 || frame > std::size(frames_offered)) return Answer::stalled;
  const Frame& chosen = frames_offered[frame - 1];
  const std::uint32_t wanted = get32(bytes, period_at);
  const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
    return std::max(a, wanted) - std::min(a, wanted) < std::max(b, wanted) - std::min(b, wanted);
  };
  probe_[frame_at] = frame;
  put32(probe_, period_at, *std::min_element(chosen.periods.begin(), chosen.periods.end(), nearer));
  put32(probe_, frame_size_at, size_of(chosen));
  if (control == commit_control) begin_stream(now_s);
  return Answer::done;
}

void Z16Camera::begin_stream(double now_s) {
  period_ns = 100 * get32(probe_, period_at);
  due_s_ = now_s;
  at_ = 0;
  streams = true;
}

std::size_t Z16Camera::frame_bytes() const {
  const std::size_t all = get32(probe_, frame_size_at);
  return fault == Fault::short_frame ? all / 2 : all;
}

/// One payload: a header, and as much of the frame as fits.
Answer Z16Camera::carry(double now_s, UsbTransfer& transfer) {
  if (!streams || transfer.endpoint != streaming_endpoint) return Answer::later;
  if (at_ == 0) {
    if (fault == Fault::frozen || now_s < due_s_) return Answer::later;
    const double period_s = 1e-9 * period_ns;
    due_s_ = std::max(due_s_ + period_s, now_s - period_s);  // frames that are too late are left out
    sent_ = picture_;
  }
  const std::size_t all = frame_bytes(), room = std::min(transfer.bytes.size(), payload_bytes);
  if (room <= header_bytes) return Answer::stalled;
  const std::size_t now = std::min(room - header_bytes, all - std::min(at_, all));
  const std::size_t there = 2 * sent_->size(), shown = std::min(now, there - std::min(there, at_));
  std::uint8_t* out = transfer.bytes.data();
  std::memset(out, 0, header_bytes);
  if (shown > 0) std::memcpy(out + header_bytes, reinterpret_cast<const std::uint8_t*>(sent_->data()) + at_, shown);
  std::memset(out + header_bytes + shown, 0, now - shown);
  at_ += now;
  const bool ends = at_ >= all;
  out[0] = header_bytes;
  out[1] = static_cast<std::uint8_t>(0x80 | toggle_ | (ends ? 2 : 0) | (fault == Fault::broken_frame ? 0x40 : 0));
  transfer.done = header_bytes + now;
  if (ends) {
    at_ = 0;
    toggle_ ^= 1;
  }
  return Answer::done;
}

/// The kernel ends a stream over a bulk endpoint by clearing its halt.
void Z16Camera::halt_cleared(std::uint8_t endpoint) {
  if (endpoint == streaming_endpoint) streams = false;
}

void Z16Camera::unplugged(double) {
  streams = false;
}

}  // namespace palpa::test
