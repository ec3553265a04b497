// Cameras, frames and boxes for the tests of this room, from a seed.
#pragma once

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <vector>

#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"

namespace palpa::test {

inline Transform random_pose(std::mt19937_64& random, double reach) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-reach, reach);
  const glm::dquat turn = glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
  Transform pose = glm::mat4_cast(turn);
  pose[3] = Vec4(unit(random), unit(random), unit(random), 1);
  return pose;
}

/// At `eye`, looking at `target`, image rows horizontal.
inline Transform look_at(const Vec3& eye, const Vec3& target) {
  const Vec3 z = glm::normalize(target - eye);
  const Vec3 x = glm::normalize(glm::cross(z, Vec3(0, 1, 0)));
  const Vec3 y = glm::cross(z, x);
  return Transform(Vec4(x, 0), Vec4(y, 0), Vec4(z, 0), Vec4(eye, 1));
}

inline sensing::Camera d415(const Transform& T_world_camera) {
  sensing::Camera camera;
  camera.name = "d415";
  camera.width = 848;
  camera.height = 480;
  camera.fx = camera.fy = 640;
  camera.cx = 423.5;
  camera.cy = 239.5;
  camera.depth_unit_m = 1e-4;
  camera.min_range_m = 0.28;
  camera.rate_hz = 90;
  camera.T_world_camera = T_world_camera;
  return camera;
}

inline std::uint32_t uniform(std::mt19937_64& random, std::uint32_t low, std::uint32_t high) {
  return std::uniform_int_distribution<std::uint32_t>(low, high)(random);
}

/// Small images of awkward widths with strong distortion, so that many pixels fold, tilt and bend.
inline sensing::Camera random_camera(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  sensing::Camera camera;
  camera.name = "random";
  camera.width = uniform(random, 1, 150);
  camera.height = uniform(random, 1, 90);
  camera.fx = 60 + 30 * unit(random);
  camera.fy = 60 + 30 * unit(random);
  camera.cx = camera.width * (0.5 + 0.4 * unit(random));
  camera.cy = camera.height * (0.5 + 0.4 * unit(random));
  camera.distortion = {0.3 * unit(random), 0.2 * unit(random), 0.02 * unit(random), 0.02 * unit(random),
                       0.1 * unit(random)};
  if (uniform(random, 0, 2) == 0) camera.distortion = {};
  camera.depth_unit_m = uniform(random, 0, 1) ? 1e-3 : 1.25e-4;
  camera.min_range_m = uniform(random, 0, 1) ? 0.2 : 0;
  // Somewhere around the origin, looking roughly at it, with any roll.
  camera.T_world_camera = random_pose(random, 0.1);
  const Vec3 forward(camera.T_world_camera[2]);
  camera.T_world_camera[3] -= Vec4(forward * (0.5 + 0.4 * std::abs(unit(random))), 0);
  return camera;
}

/// A camera as a file may have it: its lens covers the whole image.
inline sensing::Camera random_file_camera(std::mt19937_64& random) {
  sensing::Camera camera = random_camera(random);
  while (sensing::find_blind_pixel(camera)) {
    for (double& k : camera.distortion)
      k /= 2;
  }
  return camera;
}

/// Smooth surfaces between 0.3 and 1.1 m with holes.
inline sensing::DepthFrame random_frame(std::mt19937_64& random, const sensing::Camera& camera) {
  sensing::DepthFrame frame;
  frame.depth.resize(sensing::pixel_count(camera));
  std::uniform_real_distribution<double> unit(0, 1);
  const double a = unit(random), b = unit(random), c = unit(random);
  for (std::uint32_t v = 0; v < camera.height; ++v) {
    for (std::uint32_t u = 0; u < camera.width; ++u) {
      const double z = 0.7 + 0.4 * std::sin(a + 0.2 * b * u) * std::cos(c * 0.2 * v) + 0.02 * unit(random);
      const bool hole = unit(random) < 0.1;
      frame.depth[std::size_t{v} * camera.width + u] =
          hole ? 0 : static_cast<std::uint16_t>(std::min(65535.0, z / camera.depth_unit_m));
    }
  }
  return frame;
}

inline Box random_box(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double size = 0.02 + 0.5 * unit(random) * unit(random);
  Box box;
  box.add(Vec3(unit(random), unit(random), unit(random)));
  box.add(box.low +
          size * Vec3(0.5 + std::abs(unit(random)), 0.5 + std::abs(unit(random)), 0.5 + std::abs(unit(random))));
  return box;
}

}  // namespace palpa::test
