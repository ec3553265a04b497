#include "driver/v4l2/offers.hpp"

#include <fmt/core.h>
#include <linux/videodev2.h>

namespace palpa::driver::v4l2 {
namespace {

/// No device has more. A device whose list does not end is not trusted.
constexpr std::uint32_t most_entries = 64;

void add_rates(Kernel& kernel, int fd, Offer offer, std::vector<Offer>& offers) {
  for (std::uint32_t i = 0; i < most_entries; ++i) {
    v4l2_frmivalenum rate{};
    rate.index = i;
    rate.pixel_format = offer.format;
    rate.width = offer.width;
    rate.height = offer.height;
    if (kernel.ioctl(fd, VIDIOC_ENUM_FRAMEINTERVALS, &rate) < 0) {
      if (i == 0) offers.push_back(offer);
      return;
    }
    const bool each = rate.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    const v4l2_fract period = each ? rate.discrete : rate.stepwise.min;
    offer.rate_hz = period.numerator == 0 ? 0 : static_cast<double>(period.denominator) / period.numerator;
    offers.push_back(offer);
    if (!each) return;
  }
}

void add_sizes(Kernel& kernel, int fd, Offer offer, std::vector<Offer>& offers) {
  for (std::uint32_t i = 0; i < most_entries; ++i) {
    v4l2_frmsizeenum size{};
    size.index = i;
    size.pixel_format = offer.format;
    if (kernel.ioctl(fd, VIDIOC_ENUM_FRAMESIZES, &size) < 0) {
      if (i == 0) offers.push_back(offer);
      return;
    }
    const bool each = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
    offer.width = each ? size.discrete.width : size.stepwise.max_width;
    offer.height = each ? size.discrete.height : size.stepwise.max_height;
    add_rates(kernel, fd, offer, offers);
    if (!each) return;
  }
}

}  // namespace

std::vector<Offer> list_offers(Kernel& kernel, int fd) {
  std::vector<Offer> offers;
  for (std::uint32_t i = 0; i < most_entries; ++i) {
    v4l2_fmtdesc format{};
    format.index = i;
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (kernel.ioctl(fd, VIDIOC_ENUM_FMT, &format) < 0) break;
    add_sizes(kernel, fd, {.format = format.pixelformat}, offers);
  }
  return offers;
}

std::string format_name(std::uint32_t format) {
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>((format >> (8 * i)) & 0x7f);
    name += c >= ' ' && c < 0x7f ? c : '?';
  }
  while (name.ends_with(' '))
    name.pop_back();
  return name;
}

std::string list_formats(std::span<const Offer> offers) {
  const std::string names = cameras::join(offers, [](const Offer& o) { return format_name(o.format); });
  return names.empty() ? "nothing" : names;
}

}  // namespace palpa::driver::v4l2
