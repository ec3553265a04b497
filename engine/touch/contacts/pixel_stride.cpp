#include "touch/contacts/pixel_stride.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpa::touch {

FingerOptions at_stride(FingerOptions parameters, std::uint32_t stride) {
  if (stride <= 1) return parameters;
  constexpr std::uint32_t section = 3;
  const std::uint32_t fewer = (parameters.min_points + stride * stride - 1) / (stride * stride);
  parameters.min_points = std::max(std::min(parameters.min_points, section), fewer);
  return parameters;
}

std::uint32_t most_pixel_stride(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables,
                                const Box& box, const FingerOptions& parameters) {
  constexpr double most = 4;
  std::vector<sensing::Crop> crops;
  sensing::plan_crops(cameras, tables, box, crops);
  double stride = most;
  for (const sensing::Crop& crop : crops) {
    const sensing::Camera& camera = cameras[crop.camera];
    const double pixel_m = crop.depth_high * camera.depth_unit_m / std::min(camera.fx, camera.fy);
    stride = std::min(stride, parameters.finger_gap_m / (pixel_m * std::numbers::sqrt2));
  }
  return static_cast<std::uint32_t>(std::max(1.0, std::floor(stride)));
}

void set_stride(std::span<sensing::Crop> crops, std::uint32_t stride) {
  for (sensing::Crop& crop : crops)
    crop.stride = stride;
}

}  // namespace palpa::touch
