#include "touch/contacts/pixel_stride.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpa::touch {

Parameters at_stride(Parameters parameters, std::uint32_t stride) {
  if (stride <= 1) return parameters;
  constexpr std::uint32_t section = 3;
  const std::uint32_t fewer = (parameters.min_points + stride * stride - 1) / (stride * stride);
  parameters.min_points = std::max(std::min(parameters.min_points, section), fewer);
  return parameters;
}

std::uint32_t most_pixel_stride(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables,
                                const Box& box, const Parameters& parameters) {
  constexpr double most = 4;
  std::vector<sensing::View> views;
  sensing::plan_views(cameras, tables, box, views);
  double stride = most;
  for (const sensing::View& view : views) {
    const sensing::Camera& camera = cameras[view.camera];
    const double pixel_m = view.depth_high * camera.depth_unit_m / std::min(camera.fx, camera.fy);
    stride = std::min(stride, parameters.finger_gap_m / (pixel_m * std::numbers::sqrt2));
  }
  return static_cast<std::uint32_t>(std::max(1.0, std::floor(stride)));
}

void set_stride(std::span<sensing::View> views, std::uint32_t stride) {
  for (sensing::View& view : views)
    view.stride = stride;
}

}  // namespace palpa::touch
