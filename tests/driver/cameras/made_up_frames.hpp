// Cameras of a rig, and frames whose pixels tell their number.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "sensing/depth_source.hpp"
#include "support/cameras.hpp"

namespace palpa::driver::cameras::test {

/// In steps of 0.1 mm at 90 Hz.
inline sensing::Camera described(const std::string& name, std::uint32_t width = 64, std::uint32_t height = 48,
                                 double focal = 40) {
  sensing::Camera camera = palpa::test::pinhole(name, width, height, focal);
  camera.depth_unit_m = 0.0001;
  camera.rate_hz = 90;
  return camera;
}

/// The value of every pixel of frame n of a camera.
inline std::uint16_t pixel_of(std::uint64_t frame, std::uint32_t pixel) {
  return static_cast<std::uint16_t>(1 + frame % 60000 + pixel % 5);
}

/// Frame n, with so many bytes from row to row.
inline void write_frame(std::byte* to, std::uint64_t frame, std::uint32_t width, std::uint32_t height,
                        std::size_t stride) {
  std::vector<std::uint16_t> row(width);
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u)
      row[u] = pixel_of(frame, v * width + u);
    std::memcpy(to + v * stride, row.data(), row.size() * 2);
  }
}

/// The number of the frame that an image shows completely; 0 if it has no data.
inline std::uint64_t frame_of(const sensing::DepthFrame& image) {
  const std::uint64_t frame = image.depth[0] == 0 ? 0 : image.depth[0] - 1u;
  for (std::uint32_t i = 0; i < image.depth.size(); ++i) {
    const std::uint16_t expected = image.depth[0] == 0 ? std::uint16_t{0} : pixel_of(frame, i);
    if (image.depth[i] == expected) continue;
    ADD_FAILURE() << "pixel " << i << " of frame " << frame << " is " << image.depth[i];
    break;
  }
  return frame;
}

}  // namespace palpa::driver::cameras::test
