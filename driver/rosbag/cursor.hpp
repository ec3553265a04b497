// Reads little-endian values one after the other from untrusted bytes.
#pragma once

#include <algorithm>
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
  /// `aligned`: each value begins at a multiple of its size, and a text ends with a zero, as in CDR.
  explicit Cursor(std::span<const std::uint8_t> bytes, bool aligned = false)
      : bytes_(bytes), whole_(bytes.size()), aligned_(aligned) {}

  std::size_t left() const { return bytes_.size(); }

  template <typename Number>
  Number take() {
    static_assert(std::is_arithmetic_v<Number>);
    if (const std::size_t past = (whole_ - left()) % sizeof(Number); aligned_ && past > 0) bytes(sizeof(Number) - past);
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
  std::string_view text() {
    const std::string_view all = as_text(counted());
    return aligned_ && all.ends_with('\0') ? all.substr(0, all.size() - 1) : all;
  }

  static std::string_view as_text(std::span<const std::uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t whole_;
  bool aligned_;
};

}  // namespace palpa::driver::rosbag
