#include "driver/cameras/offers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

namespace palpa::driver::cameras {

std::string join(std::span<const Offer> offers, const std::function<std::string(const Offer&)>& word) {
  std::string text;
  std::vector<std::string> said;
  for (const Offer& offer : offers) {
    const std::string next = word(offer);
    if (next.empty() || std::find(said.begin(), said.end(), next) != said.end()) continue;
    text += (text.empty() ? "" : ", ") + next;
    said.push_back(next);
  }
  return text;
}

std::string list_sizes(std::span<const Offer> offers, std::uint32_t format) {
  return join(offers, [&](const Offer& o) {
    return o.format == format && o.width > 0 ? fmt::format("{}x{}", o.width, o.height) : std::string();
  });
}

std::string list_rates(std::span<const Offer> offers, std::uint32_t format, std::uint32_t width, std::uint32_t height) {
  const std::string rates = join(offers, [&](const Offer& o) {
    const bool wanted = o.format == format && o.width == width && o.height == height && o.rate_hz > 0;
    return wanted ? fmt::format("{:.3g}", o.rate_hz) : std::string();
  });
  return rates.empty() ? rates : rates + " Hz";
}

}  // namespace palpa::driver::cameras
