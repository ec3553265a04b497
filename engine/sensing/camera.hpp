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
  std::string file;                  ///< where it came from; also its name in a TOML
  std::vector<std::uint8_t> pixels;  ///< width * height of the camera, rows from the top; 0: ignored
};

/// What a camera saw without a hand. Whatever is not nearer is no skin.
struct Background {
  std::string file;                  ///< where it came from; also its name in a TOML
  std::vector<std::uint16_t> depth;  ///< width * height of the camera, in its depth unit; 0: nothing is known
  /// By how much skin is nearer than the background, at distances up to a metre. Farther away, it grows with the square
  /// of the distance, like a stereo camera's noise.
  double margin_m = 0;
};

/// Settings that a real camera gets when it is opened. They do not affect frames from other sources.
struct DeviceSetting {
  bool own_lens = false;               ///< the calibration stored in the camera replaces the file's fx fy cx cy
  std::optional<double> exposure_s;    ///< 0: the camera's own automatic; absent: unchanged
  std::optional<std::uint8_t> preset;  ///< librealsense's "hardware preset"; absent: unchanged
};

/// Camera frame: x right, y down, z forward; pixel centres at integers. Depth is the z coordinate, not the length of
/// the ray.
struct Camera {
  std::string name;
  std::uint32_t width = 0, height = 0;    ///< pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  std::array<double, 5> distortion{};     ///< k1 k2 p1 p2 k3, as OpenCV
  double depth_unit_m = 0.001;            ///< metres per step of the 16-bit depth; depth 0 means no data
  double min_range_m = 0;                 ///< nearer depths are no data
  double rate_hz = 0;                     ///< frames per second
  Transform T_world_camera{1.0};
  std::optional<double> residual_m{};  ///< of the pose: rms distance of what it saw of the target from there
  std::optional<PixelBox> roi;         ///< pixels outside are ignored; never empty, always inside the image
  std::shared_ptr<const Mask> mask;    ///< may be null; never changes, copies of a camera share it
  std::shared_ptr<const Background> background{};  ///< likewise
  DeviceSetting device{};
};

/// Why a camera hardly has this least distance, and what may be meant; empty if it is plausible.
std::string implausible_range(double min_range_m);

/// Why depths in steps of this unit are implausible, and what would be usual; empty if they are not.
std::string implausible_unit(double depth_unit_m);

/// What looks wrong in size, fx, fy, cx and cy, and what may be meant: a picture far wider or narrower than a depth
/// camera's, pixels that are no squares, a principal point outside the picture, in its corner, with its two numbers
/// exchanged, or of a picture of another size. Empty if nothing does. Lists at most one fault of the focal lengths and
/// one of the principal point.
std::string implausible_lens(const Camera& camera);

/// Whether some pixels are ignored. Ignored pixels hold no skin at any depth, for example sleeves and table tops.
inline bool ignores_pixels(const Camera& camera) {
  return camera.roi || camera.mask;
}
inline bool is_ignored(const Camera& camera, std::uint32_t u, std::uint32_t v) {
  if (camera.roi && !contains(*camera.roi, u, v)) return true;
  return camera.mask && camera.mask->pixels[std::size_t{v} * camera.width + u] == 0;
}

/// Takes away roi, mask and background.
inline void see_all(Camera& camera) {
  camera.roi.reset();
  camera.mask.reset();
  camera.background.reset();
}

/// Pixel of a point in camera coordinates (z > 0), distorted.
Vec2 project(const Camera& camera, const Vec3& point_camera);

/// A pixel that no ray of the lens model reaches, or only a ray beyond the circle where the model folds back on itself.
/// Tests the image in steps of one 32nd, including the corners (the model is a polynomial). nullopt if the lens covers
/// the whole image.
std::optional<Vec2> find_blind_pixel(const Camera& camera);

/// The smallest valid raw depth: at least 1 (0 means no data) and not nearer than `min_range_m`. Above 65535 if the
/// camera cannot represent any valid depth.
std::uint32_t first_valid_depth(const Camera& camera);

/// The largest raw depth of a pixel (rows from the top) that is nearer than the camera's background; 65535 if nothing
/// is known about that pixel.
std::uint16_t nearer_than_background(const Camera& camera, std::size_t pixel);

/// Pixels of one image.
inline std::uint64_t pixel_count(const Camera& camera) {
  return std::uint64_t{camera.width} * camera.height;
}

}  // namespace palpa::sensing
