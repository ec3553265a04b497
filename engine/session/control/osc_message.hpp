// One message of Open Sound Control (OSC 1.0). liblo reads it (osc_liblo.cpp). A palpa that was built without liblo
// reads none (osc_absent.cpp).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace palpa::session {

struct OscMessage {
  static constexpr std::size_t most = 64;
  std::string_view address;  ///< within the datagram
  /// The arguments: numbers of any type, and true and false as 1 and 0. nullopt: there are others, or more of them.
  std::optional<std::array<double, most>> numbers;
  std::size_t count = 0;

  std::span<const double> values() const {
    return numbers ? std::span(*numbers).first(count) : std::span<const double>();
  }
};

inline constexpr const char* how_to_get_liblo = "install liblo-dev (./dev deps build) and build palpa again";

/// Throws bad_usage if this palpa was built without liblo.
void check_osc();

/// nullopt: the bytes are not one message.
std::optional<OscMessage> read_osc_message(std::span<char> bytes);

}  // namespace palpa::session
