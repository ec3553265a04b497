// What a camera's node can deliver, and its description in messages.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "driver/cameras/offers.hpp"
#include "driver/v4l2/kernel.hpp"

namespace palpa::driver::v4l2 {

using cameras::Offer;

/// The offers in the device's order. If sizes or rates are given as ranges, only the largest.
std::vector<Offer> list_offers(Kernel& kernel, int fd);

/// "Z16", the four characters without unprintable ones and without blanks at the end.
std::string format_name(std::uint32_t format);
/// The formats: "Z16, GREY"; "nothing" if there are none.
std::string list_formats(std::span<const Offer> offers);

}  // namespace palpa::driver::v4l2
