// Reads little-endian values one after the other from untrusted bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string_view>
#include <type_traits>

namespace palpa::driver::rosbag {

/// There are fewer bytes than a value needs, or a value is impossible. Code that reads a file catches it and adds the
/// file's name and the place.
class Malformed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::size_t left() const { return bytes_.size(); }

  template <typename Number>
  Number take() {
    static_assert(std::is_arithmetic_v<Number>);
    Number value;
    std::memcpy(&value, bytes(sizeof(Number)).data(), sizeof(Number));
    return value;
  }
  std::span<const std::uint8_t> bytes(std::size_t count) {
    if (count > bytes_.size()) throw Malformed("a value extends past the end of its container");
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  /// The bytes that follow a length of 32 bits.
  std::span<const std::uint8_t> counted() { return bytes(take<std::uint32_t>()); }
  std::string_view text() { return as_text(counted()); }

  static std::string_view as_text(std::span<const std::uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace palpa::driver::rosbag
