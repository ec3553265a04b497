// What a camera's node can deliver, and how palpa says it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "driver/v4l2/kernel.hpp"

namespace palpa::driver::v4l2 {

/// One format, size and rate.
struct Offer {
  std::uint32_t format = 0;             ///< V4L2's four characters
  std::uint32_t width = 0, height = 0;  ///< pixels; 0 where the device names no sizes
  double rate_hz = 0;                   ///< 0 where it names none
};

/// In the device's order. Of sizes and rates that it gives as ranges, the largest.
std::vector<Offer> list_offers(Kernel& kernel, int fd);

/// "Z16", the four characters without what cannot be printed and without blanks at the end.
std::string format_name(std::uint32_t format);
/// The formats: "Z16, GREY"; "nothing" where there are none.
std::string list_formats(std::span<const Offer> offers);
/// The sizes of one format: "640x480, 848x480".
std::string list_sizes(std::span<const Offer> offers, std::uint32_t format);
/// The rates of one format at one size: "90, 60, 30 Hz".
std::string list_rates(std::span<const Offer> offers, std::uint32_t format, std::uint32_t width, std::uint32_t height);

}  // namespace palpa::driver::v4l2
