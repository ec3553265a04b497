#include "usb/d400_unit.hpp"

#include <algorithm>
#include <cstring>

namespace palpa::test {
namespace {

enum : std::uint8_t { monitor = 1, exposure = 3, preset_control = 6, auto_exposure = 0x0b };

// A letter to the monitor: length of the data after the first four bytes, magic, opcode, four parameters, data. The
// answer: the opcode again, or a negative number that identifies the error; data; its length at the end.
constexpr std::size_t letter_bytes = 1024, opcode_at = 4, parameter_at = 8, data_at = 24, length_at = 1020;
constexpr std::uint16_t magic = 0xcdab;
enum : std::uint32_t { get_calibration = 0x15, set_advanced = 0x2b, get_advanced = 0x2c };
constexpr std::uint32_t depth_control = 9, coefficients = 25, wrong_command = static_cast<std::uint32_t>(-1);

template <typename Number>
Number number_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <typename Number>
void put_at(std::vector<std::uint8_t>& bytes, std::size_t at, Number value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// The CRC of Ethernet and PNG.
std::uint32_t checksum(const std::uint8_t* begin, const std::uint8_t* end) {
  std::uint32_t crc = 0xffffffff;
  for (const std::uint8_t* at = begin; at != end; ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      const bool one = ((crc ^ *at >> bit) & 1) != 0;
      crc = crc >> 1 ^ (one ? 0xedb88320 : 0);
    }
  }
  return ~crc;
}

}  // namespace

D400Unit::D400Unit() {
  for (std::uint8_t selector = 1; selector <= 16; ++selector)
    controls_[selector].resize(4);
  controls_[monitor].resize(letter_bytes);
  controls_[preset_control].resize(1);
  controls_[auto_exposure] = {1};
  put_at<std::uint32_t>(controls_[exposure], 0, 8500);
}

std::vector<std::uint8_t> D400Unit::descriptor(std::uint8_t source) {
  return {28,   0x24, 6,    number, 0xcb, 0x6c, 0x60, 0xc9, 0x4c,   0x59, 0x25, 0x4d, 0xaf, 0x47,
          0xcc, 0xc4, 0x96, 0x43,   0x59, 0x95, 16,   1,    source, 3,    0xff, 0xdd, 0x00, 0};
}

Answer D400Unit::control(const ControlRequest& request, std::vector<std::uint8_t>& bytes) {
  const auto found = controls_.find(high(request.value));
  if (found == controls_.end() || (busy > 0 && busy-- > 0)) return Answer::stalled;
  std::vector<std::uint8_t>& current = found->second;
  switch (request.request) {
    case set_cur:
      if (bytes.size() != current.size()) return Answer::stalled;
      if (found->first == exposure && automatic()) return Answer::stalled;  // the automatic goes first
      current = bytes;
      if (found->first == monitor) obey();
      return Answer::done;
    case get_len:
      bytes = {low(static_cast<unsigned>(current.size())), high(static_cast<unsigned>(current.size()))};
      return Answer::done;
    case get_info:
      bytes = {3};
      return Answer::done;
    case get_cur:
      bytes = current;
      bytes.resize(std::min<std::size_t>(bytes.size(), request.length));
      return Answer::done;
    default:
      return Answer::stalled;
  }
}

std::uint32_t D400Unit::value(std::uint8_t selector, std::size_t size) const {
  std::uint32_t value = 0;
  std::memcpy(&value, controls_.at(selector).data(), size);
  return value;
}

/// The answer replaces the letter in the box.
void D400Unit::obey() {
  const std::vector<std::uint8_t> letter = controls_[monitor];
  const auto length = number_at<std::uint16_t>(letter, 0);
  const auto opcode = number_at<std::uint32_t>(letter, opcode_at);
  const auto parameter = number_at<std::uint32_t>(letter, parameter_at);
  constexpr std::size_t fields = data_at - opcode_at;
  std::vector<std::uint8_t> table(sizeof depth_table);
  const std::size_t data = opcode == set_advanced ? table.size() : 0;
  if (number_at<std::uint16_t>(letter, 2) != magic || length != fields + data) return reply(wrong_command, {});
  if (opcode == get_advanced && parameter == depth_control) {
    std::memcpy(table.data(), depth_table.data(), table.size());
    return reply(opcode, table);
  }
  if (opcode == set_advanced && parameter == depth_control) {
    if (!keeps_unit) std::memcpy(depth_table.data(), letter.data() + data_at, table.size());
    return reply(opcode, {});
  }
  if (opcode == get_calibration && parameter == coefficients) return reply(opcode, calibration());
  reply(wrong_command, {});
}

void D400Unit::reply(std::uint32_t echo, const std::vector<std::uint8_t>& data) {
  std::vector<std::uint8_t>& box = controls_[monitor];
  std::fill(box.begin(), box.end(), std::uint8_t{0});
  put_at(box, 0, echo);
  std::copy(data.begin(), data.end(), box.begin() + 4);
  put_at(box, length_at, static_cast<std::uint32_t>(data.size()));
}

/// A header of 16 bytes, 240 bytes about the two imagers, then a lens for each size; 848x480 is the fourth.
std::vector<std::uint8_t> D400Unit::calibration() const {
  constexpr std::size_t header = 16, lenses_at = 256, lens_bytes = 16, all = 512;
  std::vector<std::uint8_t> table(all);
  put_at<std::uint16_t>(table, 2, coefficients);
  put_at<std::uint32_t>(table, 4, all - header);
  std::memcpy(table.data() + lenses_at + 3 * lens_bytes, lens.data(), lens_bytes);
  put_at(table, 12, checksum(table.data() + header, table.data() + all) ^ (wrong_checksum ? 1 : 0));
  return table;
}

}  // namespace palpa::test
