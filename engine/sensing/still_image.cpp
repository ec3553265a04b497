#include "sensing/still_image.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"
#include "sensing/rays.hpp"

namespace palpa::sensing {
namespace {

/// For something that stands still, the middle half of a pixel's depths lies within this range; noise grows with the
/// square of the distance.
constexpr double still_m = 3e-3, still_at_m = 0.5;
/// The step between pixels beside which depths are invented, and the number of affected pixels on either side. A plane
/// seen at 15 degrees has steps of less than four times the width of a pixel: 3 mm at 0.5 m and a focal length of 600
/// pixels.
constexpr double step_m = 5e-3, step_px = 4;
constexpr std::int64_t rim_px = 2;

/// In metres, 0 if there is none.
double middle_depth(std::vector<std::uint16_t>& depths, std::size_t frames, double unit_m) {
  const std::size_t n = depths.size();
  if (n == 0 || 2 * n <= frames) return 0;
  std::sort(depths.begin(), depths.end());
  const std::size_t skip = n / 4;
  const double spread = (depths[n - 1 - skip] - depths[skip]) * unit_m;
  const auto begin = depths.begin() + static_cast<std::ptrdiff_t>(skip);
  const auto end = depths.end() - static_cast<std::ptrdiff_t>(skip);
  const double z = std::accumulate(begin, end, 0.0) / static_cast<double>(end - begin) * unit_m;
  const double far = std::max(1.0, z / still_at_m);
  return spread > still_m * far * far + unit_m ? 0 : z;
}

/// Marks pixels that have a step in depth, or a pixel without data, near them.
std::vector<bool> near_steps(const std::vector<double>& depth, std::uint32_t width, std::uint32_t height,
                             double focal_px) {
  std::vector<bool> near(depth.size(), false);
  const auto mark = [&](std::int64_t u, std::int64_t v, std::int64_t du, std::int64_t dv) {
    for (std::int64_t i = 1 - rim_px; i <= rim_px; ++i) {
      const std::int64_t x = u + i * du, y = v + i * dv;
      if (x >= 0 && y >= 0 && x < width && y < height) near[static_cast<std::size_t>(y * width + x)] = true;
    }
  };
  for (std::int64_t v = 0; v < height; ++v) {
    for (std::int64_t u = 0; u < width; ++u) {
      const double z = depth[static_cast<std::size_t>(v * width + u)];
      const double least = std::max(step_m, step_px * z / focal_px);
      const auto steps = [&](std::int64_t x, std::int64_t y) {
        return std::abs(depth[static_cast<std::size_t>(y * width + x)] - z) > least;
      };
      if (u + 1 < width && steps(u + 1, v)) mark(u, v, 1, 0);
      if (v + 1 < height && steps(u, v + 1)) mark(u, v, 0, 1);
    }
  }
  return near;
}

}  // namespace

void StillFrames::add(std::span<const std::uint16_t> depth, std::optional<std::uint64_t> number) {
  if (depth.size() != pixel_count(camera_)) throw bad_usage("a depth frame has another size than its camera");
  last_ = number.value_or(frames_.empty() ? 0 : last_ + 1);
  if (frames_.empty()) first_ = last_;
  frames_.emplace_back(depth.begin(), depth.end());
}

StillImage StillFrames::finish() const {
  StillImage image;
  image.width = camera_.width;
  image.height = camera_.height;
  image.frames = frames_.size();
  image.first = first_;
  image.last = last_;
  image.points.assign(pixel_count(camera_), glm::vec3(0));
  const std::uint32_t first = first_valid_depth(camera_);
  std::vector<double> depth(image.points.size(), 0);
  std::vector<std::uint16_t> values;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    values.clear();
    for (const std::vector<std::uint16_t>& frame : frames_) {
      if (frame[i] >= first) values.push_back(frame[i]);
    }
    image.deep += values.empty() ? 0 : 1;
    depth[i] = middle_depth(values, frames_.size(), camera_.depth_unit_m);
  }
  const std::vector<bool> rim = near_steps(depth, image.width, image.height, std::min(camera_.fx, camera_.fy));

  Camera whole = camera_;
  see_all(whole);
  const RayTables tables = make_rays(std::span(&whole, 1));
  for (std::uint32_t v = 0; v < image.height; ++v) {
    for (std::uint32_t u = 0; u < image.width; ++u) {
      const std::size_t i = std::size_t{v} * image.width + u;
      const glm::vec2& ray = tables.rays[std::size_t{v} * tables.cameras[0].pitch + u];
      if (depth[i] <= 0 || rim[i] || ray.x >= no_ray) continue;
      image.points[i] = glm::vec3(ray.x, ray.y, 1.0F) * static_cast<float>(depth[i]);
      ++image.seen;
    }
  }
  return image;
}

}  // namespace palpa::sensing
