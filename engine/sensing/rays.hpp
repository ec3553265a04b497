// The ray of every pixel, computed once, and the part of each image that can show a point inside a box.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"

namespace palpa::sensing {

/// Images and ray tables on the device share one arrangement: cameras one after the other, every row padded to a whole
/// number of blocks of 8 pixels, so that one 16-byte load reads one block of depths.
inline constexpr std::uint32_t block_pixels = 8;
/// Side of the square tiles whose rays are bounded.
inline constexpr std::uint32_t tile_pixels = 16;

/// Bounds of the rays of a tile's pixels (those that have a ray); empty if low > high.
struct RayBounds {
  glm::vec2 low{1e30f}, high{-1e30f};
};

/// Where one camera lies in the shared arrangement.
struct CameraTable {
  std::uint32_t width = 0, height = 0;
  std::uint32_t pitch = 0;        ///< pixels from row to row, a multiple of block_pixels
  std::uint64_t first_pixel = 0;  ///< of the padded arrangement, a multiple of block_pixels
  std::uint64_t first_index = 0;  ///< of the skin points' indices: number of pixels of the earlier cameras
  bool pinhole = false;     ///< no distortion, no ignored pixels: the ray is ((u - cx) * per_fx, (v - cy) * per_fy), in
                            ///< float
  bool background = false;  ///< RayTables::limits hold something for it
  float cx = 0, cy = 0, per_fx = 0, per_fy = 0;
  float reach = 0;  ///< the square of the image's longest ray, including ignored pixels
  std::uint32_t tiles_x = 0, tiles_y = 0;
  std::vector<RayBounds> tile_rows;  ///< tiles_y of them, each the bounds of its tiles
  std::vector<RayBounds> tiles;      ///< tiles_x * tiles_y, rows from the top
};

/// Normalised coordinates (x/z, y/z) of every pixel's ray in float. Pixels without a ray, ignored pixels and the
/// padding hold no_ray.
struct RayTables {
  std::vector<CameraTable> cameras;
  std::vector<glm::vec2> rays;  ///< size padded_pixels
  /// Size padded_pixels, or empty if no camera has a background: the largest raw depth of each pixel that is nearer
  /// than the camera's background, 65535 if nothing is known there.
  std::vector<std::uint16_t> limits;
  std::uint64_t padded_pixels = 0;
  std::uint64_t pixels = 0;  ///< without padding: the maximum number of skin points
};

/// So large that no depth brings it into a box.
inline constexpr float no_ray = 1e18f;

/// The maximum number of padded pixels of all cameras together: what fits into a storage buffer on every device.
inline constexpr std::uint64_t most_pixels = 1u << 23;

/// RayTables::padded_pixels for these cameras.
std::uint64_t padded_pixels(std::span<const Camera> cameras);

/// Throws bad_usage if the cameras together have more than `most_pixels` pixels, or if the size of a mask or of a
/// background differs from its camera's.
RayTables make_rays(std::span<const Camera> cameras);

/// The part of one camera's image that can show a point of the box, and everything needed to turn its depths into
/// points.
struct Crop {
  std::uint32_t camera = 0;
  std::uint32_t first_column = 0;  ///< a multiple of block_pixels
  std::uint32_t first_row = 0;
  std::uint32_t blocks_per_row = 0, rows = 0;
  std::uint32_t depth_low = 1, depth_high = 0;  ///< raw depths outside [low, high] cannot be in the box, or are no data
  float depth_unit = 0;                         ///< metres
  float rows_of_pose[3][4] = {};                ///< upper three rows of T_world_camera
  std::uint32_t stride = 1;  ///< only every n-th pixel of every n-th row is used, counted from the image's corner

  std::uint32_t blocks() const { return blocks_per_row * rows; }
};

/// Replaces `crops` by the crops, in camera order, of those cameras that can show a point of `box` (world).
/// Conservative: a pixel outside every crop cannot hold a point of the box. Allocates nothing once `crops` has room for
/// every camera.
void plan_crops(std::span<const Camera> cameras, const RayTables& tables, const Box& box, std::vector<Crop>& crops);

/// Throws bad_usage unless there is one image per camera, of its size.
void check_frames(const RayTables& tables, std::span<const DepthFrame> frames);

/// Copies the frames' depths into the shared arrangement (2 bytes per padded pixel), padding 0. Throws bad_usage unless
/// there is one frame of the right size per camera.
void pack_depth(const RayTables& tables, std::span<const DepthFrame> frames, std::span<std::uint16_t> packed);

/// The number of pixels with data that are neither ignored nor background: "points" in the output of `palpa touch` with
/// depth frames.
std::uint64_t count_valid(std::span<const Camera> cameras, std::span<const DepthFrame> frames);

}  // namespace palpa::sensing
