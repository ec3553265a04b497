// The pinhole camera of a depth sensor, with Brown-Conrady distortion.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "sensing/pixel_box.hpp"

namespace palpa::sensing {

/// Which pixels of a camera may be skin.
struct Mask {
  std::string file;                  ///< where it came from, and under which name it is written into a TOML
  std::vector<std::uint8_t> pixels;  ///< width * height of the camera, rows from the top; 0: ignored
};

/// What a real camera is set to when it is opened; frames that come from elsewhere take no notice of it.
struct DeviceSetting {
  bool own_lens = false;               ///< fx fy cx cy of the calibration that it keeps take the place of the file's
  std::optional<double> exposure_s;    ///< 0: its own automatic; absent: as it is
  std::optional<std::uint8_t> preset;  ///< librealsense's "hardware preset"; absent: as it is
};

/// Camera frame: x right, y down, z forward; pixel centres at integers. Depth is the z coordinate, not the ray's
/// length.
struct Camera {
  std::string name;
  std::uint32_t width = 0, height = 0;    ///< pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  std::array<double, 5> distortion{};     ///< k1 k2 p1 p2 k3, as OpenCV
  double depth_unit_m = 0.001;            ///< metres per step of the 16-bit depth; depth 0 means no data
  double min_range_m = 0;                 ///< depths nearer than this are no data
  double rate_hz = 0;                     ///< frames per second
  Transform T_world_camera{1.0};
  std::optional<PixelBox> roi;       ///< pixels outside are ignored; not empty and within the image
  std::shared_ptr<const Mask> mask;  ///< may be none; never changes, copies of a camera share it
  DeviceSetting device{};
};

/// Ignored pixels hold no skin, whatever their depth. Sleeves and table tops are no skin.
inline bool ignores_pixels(const Camera& camera) {
  return camera.roi || camera.mask;
}
inline bool is_ignored(const Camera& camera, std::uint32_t u, std::uint32_t v) {
  if (camera.roi && !contains(*camera.roi, u, v)) return true;
  return camera.mask && camera.mask->pixels[std::size_t{v} * camera.width + u] == 0;
}

/// Pixel of a point in camera coordinates (z > 0), distorted.
Vec2 project(const Camera& camera, const Vec3& point_camera);
/// Normalised coordinates (x/z, y/z) of the ray through a pixel: undoes the distortion to within 1e-9. Both are NaN
/// where the lens model sends no ray to that pixel, or only one beyond the circle where the model folds back on itself.
Vec2 undistort(const Camera& camera, const Vec2& pixel);
/// World point of pixel (u, v) at raw depth d > 0, in double precision.
Vec3 deproject(const Camera& camera, double u, double v, std::uint16_t depth);

/// A pixel for which undistort() finds no ray, looked for in steps of a 32nd of the image, its corners among them (the
/// model is a polynomial); nullopt where the lens reaches the whole image.
std::optional<Vec2> find_blind_pixel(const Camera& camera);

/// The smallest raw depth that is data: at least 1 (0 means no data) and not nearer than `min_range_m`. Above 65535
/// where the camera can hold no valid depth at all.
std::uint32_t first_valid_depth(const Camera& camera);

/// Pixels of one image.
inline std::uint64_t pixel_count(const Camera& camera) {
  return std::uint64_t{camera.width} * camera.height;
}

}  // namespace palpa::sensing
