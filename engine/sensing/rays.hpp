// The ray of every pixel, computed once, and the part of each image that can show anything inside a box.
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
/// number of blocks of 8 pixels, so that one 16-byte load brings one block of depths.
inline constexpr std::uint32_t block_pixels = 8;
/// Side of the square tiles whose rays are bounded.
inline constexpr std::uint32_t tile_pixels = 16;

/// Bounds of the rays of a tile's pixels (of those that have one); empty when low > high.
struct RayBounds {
  glm::vec2 low{1e30f}, high{-1e30f};
};

/// Where one camera lies in the common arrangement.
struct CameraTable {
  std::uint32_t width = 0, height = 0;
  std::uint32_t pitch = 0;        ///< pixels from row to row, a multiple of block_pixels
  std::uint64_t first_pixel = 0;  ///< of the padded arrangement, a multiple of block_pixels
  std::uint64_t first_index = 0;  ///< of the skin points' indices: pixels of the earlier cameras
  bool pinhole = false;  ///< nothing distorted or ignored: the ray is ((u - cx) * per_fx, (v - cy) * per_fy), in float
  float cx = 0, cy = 0, per_fx = 0, per_fy = 0;
  float reach = 0;  ///< the square of the picture's longest ray, those of ignored pixels among them
  std::uint32_t tiles_x = 0, tiles_y = 0;
  std::vector<RayBounds> tile_rows;  ///< tiles_y, each the bounds of its tiles
  std::vector<RayBounds> tiles;      ///< tiles_x * tiles_y, rows from the top
};

/// Normalised coordinates (x/z, y/z) of every pixel's ray in float. A pixel without a ray or that its camera ignores,
/// and the padding, hold no_ray.
struct RayTables {
  std::vector<CameraTable> cameras;
  std::vector<glm::vec2> rays;  ///< padded_pixels of them
  std::uint64_t padded_pixels = 0;
  std::uint64_t pixels = 0;  ///< without padding: the most skin points there can be
};

/// So far off that no depth brings it into a box.
inline constexpr float no_ray = 1e18f;

/// Most padded pixels that all cameras may have together: what fits a storage buffer on every device.
inline constexpr std::uint64_t most_pixels = 1u << 23;

/// What make_rays() makes of that many pixels.
std::uint64_t padded_pixels(std::span<const Camera> cameras);

/// Throws bad_usage when the cameras have more than `most_pixels` pixels together, or a mask not one for each of its
/// own.
RayTables make_rays(std::span<const Camera> cameras);

/// The part of one camera's image that can show a point of the box, and all that turns its depths into points.
struct Crop {
  std::uint32_t camera = 0;
  std::uint32_t first_column = 0;  ///< a multiple of block_pixels
  std::uint32_t first_row = 0;
  std::uint32_t blocks_per_row = 0, rows = 0;
  std::uint32_t depth_low = 1, depth_high = 0;  ///< raw depths outside [low, high] cannot be in the box, or are no data
  float depth_unit = 0;                         ///< metres
  float rows_of_pose[3][4] = {};                ///< upper three rows of T_world_camera
  std::uint32_t stride = 1;  ///< only every n-th pixel of every n-th row is looked at, counted from the image's corner

  std::uint32_t blocks() const { return blocks_per_row * rows; }
};

/// Replaces `crops` by those cameras' crops, in camera order, that can show a point of `box` (world). Conservative: a
/// pixel outside every crop cannot hold a point of the box. Allocates nothing once `crops` has room for every camera.
void plan_crops(std::span<const Camera> cameras, const RayTables& tables, const Box& box, std::vector<Crop>& crops);

/// Copies the frames' depths into the common arrangement (2 bytes per padded pixel), padding 0. Throws bad_usage unless
/// there is one frame of the right size per camera.
void pack_depth(const RayTables& tables, std::span<const DepthFrame> frames, std::span<std::uint16_t> packed);

/// Pixels that are data and not ignored: what `palpa touch` reports as "points" with depth frames.
std::uint64_t count_valid(std::span<const Camera> cameras, std::span<const DepthFrame> frames);

}  // namespace palpa::sensing
