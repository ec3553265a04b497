// What a camera can deliver, and its description in messages.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace palpa::driver::cameras {

/// One format, size and rate.
struct Offer {
  std::uint32_t format = 0;             ///< V4L2's four characters; 0 for librealsense2, which is only asked for Z16
  std::uint32_t width = 0, height = 0;  ///< pixels; 0 if the device names no sizes
  double rate_hz = 0;                   ///< 0 if it names none
};

/// The sizes of one format: "640x480, 848x480".
std::string list_sizes(std::span<const Offer> offers, std::uint32_t format);
/// The rates of one format at one size: "90, 60, 30 Hz".
std::string list_rates(std::span<const Offer> offers, std::uint32_t format, std::uint32_t width, std::uint32_t height);

/// Joins what `word(offer)` returns for each offer, without empty words and repetitions.
std::string join(std::span<const Offer> offers, const std::function<std::string(const Offer&)>& word);

}  // namespace palpa::driver::cameras
