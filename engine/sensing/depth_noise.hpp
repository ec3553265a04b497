// Turns exact depths into what a stereo depth camera reports. Counter-based: a pixel's noise depends only on its key
// and place.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "sensing/camera.hpp"
#include "sensing/pixel_box.hpp"

namespace palpa::sensing {

/// Depth of a pixel that shows nothing; every real depth is smaller.
inline constexpr float beyond = 1e9f;

/// The errors of a stereo camera. Noise is defined in disparity fx * baseline / z: a standard deviation of sigma_px in
/// disparity is z^2 * sigma_px / (fx * baseline) in depth (Keselman et al., "Intel RealSense Stereoscopic Depth
/// Cameras", CVPRW 2017).
struct D415 {
  static constexpr double baseline_m = 0.055;
  static constexpr double sigma_px = 0.08;
  static constexpr double disparity_step_px = 1.0 / 32;
  // The noise is white noise smoothed by [1 2 1]/4 in both directions and scaled back to sigma_px: its correlation is
  // 2/3 with the next pixel, 1/6 with the one after, and 0 beyond.
  static constexpr double jump_m = 0.01;      ///< a larger step in depth is a silhouette
  static constexpr int rim_px = 2;            ///< pixels this near to a silhouette, along rows or columns, are
                                              ///< affected:
  static constexpr double rim_holes = 0.5;    ///< this share of them has no data
  static constexpr double rim_flying = 0.15;  ///< and this share lies between the two sides
  /// Share of holes by the cosine of incidence: all below the first value, none above the second, linear between.
  static constexpr double grazing_all = 0.1, grazing_none = 0.3;
};

/// One camera's exact image: width * height values of depth (metres along z, or `beyond`) and slant (|ray . unit
/// normal|; divided by the ray's length it is the cosine of incidence), and its rays, `pitch` per row.
struct DepthImage {
  const Camera& camera;
  std::span<const float> depth, slant;
  std::span<const glm::vec2> rays;
  std::uint32_t pitch;
};

/// Exact depths rounded to the camera's unit; 0 for pixels that show nothing, are nearer than the range or beyond 65535
/// units.
void quantize(const DepthImage& image, std::vector<std::uint16_t>& out);

/// A different random stream for every frame of every camera.
std::uint64_t noise_key(std::uint64_t seed, std::uint64_t sequence, std::uint64_t camera);

/// The errors that a pixel's place in the image can cause.
enum class Risk : std::uint8_t {
  nothing,      ///< there is nothing to see
  none,         ///< only noise
  grazing = 2,  ///< seen at such a flat angle that it may be a hole
  rim = 3,      ///< near a silhouette: it may be a hole, or lie between the two sides
};

/// Finds the risks of the pixels in `box` from everything up to rim_px around them. `risks` covers the whole image.
void find_risks(const DepthImage& image, const PixelBox& box, std::span<Risk> risks);

/// The part of a row of pixels, end excluded, that contains everything visible.
struct RowSpan {
  std::uint32_t begin = 0, end = 0;
};

/// Adds the D415's faults, then quantizes. Keeps its working rows between calls.
class DepthNoise {
 public:
  /// `risks` of every pixel, `spans` of every row. A live rig knows both in advance, except where the skin is.
  void apply(const DepthImage& image, std::span<const Risk> risks, std::span<const RowSpan> spans, std::uint64_t key,
             std::vector<std::uint16_t>& out);

 private:
  std::vector<float> white_, smooth_;  ///< one row of white noise; three rows smoothed along u
  std::vector<std::int32_t> raw_;      ///< one row of depths
};

}  // namespace palpa::sensing
