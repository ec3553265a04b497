// What a camera can deliver, and how palpa says it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace palpa::driver::cameras {

/// One format, size and rate.
struct Offer {
  std::uint32_t format = 0;             ///< V4L2's four characters; of librealsense2, which is asked for Z16 alone, 0
  std::uint32_t width = 0, height = 0;  ///< pixels; 0 where the device names no sizes
  double rate_hz = 0;                   ///< 0 where it names none
};

/// The sizes of one format: "640x480, 848x480".
std::string list_sizes(std::span<const Offer> offers, std::uint32_t format);
/// The rates of one format at one size: "90, 60, 30 Hz".
std::string list_rates(std::span<const Offer> offers, std::uint32_t format, std::uint32_t width, std::uint32_t height);

/// Joins what `word(offer)` says of each offer, leaving out what is empty or said already.
std::string join(std::span<const Offer> offers, const std::function<std::string(const Offer&)>& word);

}  // namespace palpa::driver::cameras
