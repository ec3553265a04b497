#include "viewer/picture/depth_image.hpp"

#include <algorithm>

#include "viewer/picture/palette.hpp"

namespace palpa::viewer {
namespace {

constexpr std::uint32_t longest_side = 240;

/// The depths with the lightest and the darkest colour.
std::pair<double, double> range_of(std::vector<std::uint16_t> depths) {
  if (depths.empty()) return {0, 1};
  const auto at = [&](std::size_t index) {
    const auto place = depths.begin() + static_cast<std::ptrdiff_t>(index);
    std::nth_element(depths.begin(), place, depths.end());
    return static_cast<double>(*place);
  };
  const double near = at(depths.size() / 20), far = at(depths.size() - 1 - depths.size() / 20);
  return {near, std::max(far, near + 1)};
}

}  // namespace

void paint_depth(const sensing::Camera& camera, const sensing::DepthFrame& frame, ImageMark& image) {
  image.width = image.height = 0;
  image.pixels.clear();
  if (frame.depth.size() != sensing::pixel_count(camera)) return;
  const std::uint32_t step = (std::max(camera.width, camera.height) + longest_side - 1) / longest_side;
  image.width = (camera.width + step - 1) / step;
  image.height = (camera.height + step - 1) / step;
  const auto depth_at = [&](std::uint32_t x, std::uint32_t y) {
    const std::uint32_t u = std::min(x * step + step / 2, camera.width - 1);
    const std::uint32_t v = std::min(y * step + step / 2, camera.height - 1);
    const std::uint16_t depth = frame.depth[std::size_t{v} * camera.width + u];
    return depth < sensing::first_valid_depth(camera) ? std::uint16_t{0} : depth;
  };
  std::vector<std::uint16_t> depths;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      if (const std::uint16_t depth = depth_at(x, y)) depths.push_back(depth);
    }
  }
  const auto [near, far] = range_of(std::move(depths));
  image.pixels.reserve(std::size_t{image.width} * image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::uint16_t depth = depth_at(x, y);
      const double nearness = 1 - (depth - near) / (far - near);
      image.pixels.push_back(to_pixel(depth == 0 ? rgb(0x66727f, 0.25f) : drawing::map_colour(nearness)));
    }
  }
}

}  // namespace palpa::viewer
