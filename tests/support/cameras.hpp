// Cameras for tests.
#pragma once

#include <cstdint>
#include <string>

#include "sensing/camera.hpp"

namespace palpa::test {

/// At the origin, looking along z, without distortion, its optical axis in the middle of the image. `focal`: pixels.
inline sensing::Camera pinhole(const std::string& name, std::uint32_t width, std::uint32_t height, double focal) {
  sensing::Camera camera;
  camera.name = name;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

}  // namespace palpa::test
