#include "sensing/rays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sensing/lens.hpp"

namespace palpa::sensing {
namespace {

constexpr std::uint32_t round_up(std::uint32_t value, std::uint32_t step) {
  return (value + step - 1) / step * step;
}

/// Bounds, in normalised coordinates and depth, of the part of a box that a camera can see.
struct Outline {
  Vec2 low{1e300}, high{-1e300};
  double near = 1e300, far = -1e300;

  void add(const Vec3& p) {
    const Vec2 n = Vec2(p) / p.z;
    low = glm::dvec2(std::min(low.x, n.x), std::min(low.y, n.y));
    high = glm::dvec2(std::max(high.x, n.x), std::max(high.y, n.y));
    near = std::min(near, p.z);
    far = std::max(far, p.z);
  }
  bool empty() const { return near > far; }
};

/// The box in camera coordinates, clipped at the depth `nearest` > 0, as seen from the camera. A convex body in front
/// of the camera projects into the bounds of its projected corners.
Outline outline(const Camera& camera, const Box& box, double nearest) {
  const Transform T_camera_world = glm::inverse(camera.T_world_camera);
  std::array<Vec3, 8> corners = box.corners();
  for (Vec3& corner : corners)
    corner = transform_point(T_camera_world, corner);
  Outline out;
  for (unsigned i = 0; i < 8; ++i) {
    if (corners[i].z >= nearest) out.add(corners[i]);
    for (unsigned axis = 1; axis < 8; axis <<= 1) {  // the three edges that go up from corner i
      if (i & axis) continue;
      const Vec3 &a = corners[i], &b = corners[i | axis];
      if ((a.z < nearest) == (b.z < nearest)) continue;
      const double t = (nearest - a.z) / (b.z - a.z);
      out.add(Vec3(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), nearest));
    }
  }
  return out;
}

/// The box enlarged by the rounding errors of float arithmetic, and without infinities.
Box grown(const Camera& camera, const Box& box) {
  constexpr double world = 1e6;  // metres
  const Vec3 low = glm::clamp(box.low, Vec3(-world), Vec3(world)),
             high = glm::clamp(box.high, Vec3(-world), Vec3(world));
  double largest = 1;
  for (int i = 0; i < 3; ++i) {
    largest = std::max({largest, std::abs(low[i]), std::abs(high[i]), std::abs(camera.T_world_camera[3][i])});
  }
  const Vec3 margin(1e-6 * largest);  // 16 roundings of 2^-24
  return {low - margin, high + margin};
}

struct TileRange {
  std::uint32_t x0 = ~0u, y0 = ~0u, x1 = 0, y1 = 0;  // inclusive
  bool empty() const { return x0 > x1; }
};

TileRange find_tiles(const CameraTable& table, const glm::vec2& low, const glm::vec2& high) {
  TileRange range;
  const RayBounds* tile = table.tiles.data();
  for (std::uint32_t y = 0; y < table.tiles_y; ++y) {
    for (std::uint32_t x = 0; x < table.tiles_x; ++x, ++tile) {
      if (tile->low.x > high.x || tile->high.x < low.x || tile->low.y > high.y || tile->high.y < low.y) continue;
      range.x0 = std::min(range.x0, x);
      range.y0 = std::min(range.y0, y);
      range.x1 = std::max(range.x1, x);
      range.y1 = y;
    }
  }
  return range;
}

bool is_distorted(const Camera& camera) {
  return std::any_of(camera.distortion.begin(), camera.distortion.end(), [](double k) { return k != 0; });
}

void fill_rays(const Camera& camera, CameraTable& table, std::span<glm::vec2> rays) {
  const Lens lens(camera.distortion, true);
  const bool distorted = is_distorted(camera);
  for (std::uint32_t v = 0; v < table.height; ++v) {
    std::optional<Vec2> guess;  // the neighbour's ray
    glm::vec2* row = rays.data() + std::size_t{v} * table.pitch;
    for (std::uint32_t u = 0; u < table.width; ++u) {
      glm::vec2 ray((static_cast<float>(u) - table.cx) * table.per_fx,
                    (static_cast<float>(v) - table.cy) * table.per_fy);
      if (distorted) {
        const Vec2 target{(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy};
        const auto undone = lens.undo(target, guess.value_or(target));
        guess = undone;
        if (!undone || !(std::abs(undone->x) < 1e6 && std::abs(undone->y) < 1e6)) continue;
        ray = glm::vec2(*undone);
      }
      table.reach = std::max(table.reach, ray.x * ray.x + ray.y * ray.y);
      if (is_ignored(camera, u, v)) continue;
      row[u] = ray;
      RayBounds& tile = table.tiles[std::size_t{v / tile_pixels} * table.tiles_x + u / tile_pixels];
      tile.low = glm::vec2(std::min(tile.low.x, ray.x), std::min(tile.low.y, ray.y));
      tile.high = glm::vec2(std::max(tile.high.x, ray.x), std::max(tile.high.y, ray.y));
    }
  }
}

/// The same rays, tiles and reach for a pinhole camera that ignores no pixel, with a column's work done once for all
/// rows. Rays are in the order of columns and rows, which rounding keeps, so a tile's first and last one bound it.
void fill_pinhole_rays(CameraTable& table, std::span<glm::vec2> rays) {
  if (rays.empty()) return;
  const auto x_of = [&](std::uint32_t u) { return (static_cast<float>(u) - table.cx) * table.per_fx; };
  const auto y_of = [&](std::uint32_t v) { return (static_cast<float>(v) - table.cy) * table.per_fy; };
  std::vector<float> x(table.width);
  for (std::uint32_t u = 0; u < table.width; ++u)
    x[u] = x_of(u);
  for (std::uint32_t v = 0; v < table.height; ++v) {
    const float y = y_of(v);
    glm::vec2* const row = rays.data() + std::size_t{v} * table.pitch;
    for (std::uint32_t u = 0; u < table.width; ++u)
      row[u] = glm::vec2(x[u], y);
  }
  const auto farthest = [](float first, float last) { return std::max(first * first, last * last); };
  table.reach = farthest(x.front(), x.back()) + farthest(y_of(0), y_of(table.height - 1));
  for (std::size_t i = 0; i < table.tiles.size(); ++i) {
    const auto u = static_cast<std::uint32_t>(i % table.tiles_x) * tile_pixels;
    const auto v = static_cast<std::uint32_t>(i / table.tiles_x) * tile_pixels;
    const glm::vec2 first(x_of(u), y_of(v)),
        last(x_of(std::min(u + tile_pixels, table.width) - 1), y_of(std::min(v + tile_pixels, table.height) - 1));
    table.tiles[i].low = glm::min(table.tiles[i].low, glm::min(first, last));
    table.tiles[i].high = glm::max(table.tiles[i].high, glm::max(first, last));
  }
}

std::vector<RayBounds> bound_rows(const CameraTable& table) {
  std::vector<RayBounds> rows(table.tiles_y);
  for (std::size_t i = 0; i < table.tiles.size(); ++i) {
    RayBounds& row = rows[i / table.tiles_x];
    row.low = glm::min(row.low, table.tiles[i].low);
    row.high = glm::max(row.high, table.tiles[i].high);
  }
  return rows;
}

}  // namespace

std::uint64_t padded_pixels(std::span<const Camera> cameras) {
  std::uint64_t pixels = 0;
  for (const Camera& camera : cameras)
    pixels += std::uint64_t{round_up(camera.width, block_pixels)} * camera.height;
  return pixels;
}

RayTables make_rays(std::span<const Camera> cameras) {
  RayTables tables;
  for (const Camera& camera : cameras) {
    if (camera.mask && camera.mask->pixels.size() != std::size_t{camera.width} * camera.height) {
      throw bad_usage(fmt::format("camera {}: its mask has {} pixels, but its image has {} x {}", camera.name,
                                  camera.mask->pixels.size(), camera.width, camera.height));
    }
    if (camera.background && camera.background->depth.size() != pixel_count(camera)) {
      throw bad_usage(fmt::format("camera {}: its background has {} pixels, but its image has {} x {}", camera.name,
                                  camera.background->depth.size(), camera.width, camera.height));
    }
    CameraTable& table = tables.cameras.emplace_back();
    table.width = camera.width;
    table.height = camera.height;
    table.background = camera.background != nullptr;
    table.pinhole = !is_distorted(camera) && !ignores_pixels(camera);
    table.cx = static_cast<float>(camera.cx);
    table.cy = static_cast<float>(camera.cy);
    table.per_fx = static_cast<float>(1 / camera.fx);
    table.per_fy = static_cast<float>(1 / camera.fy);
    table.pitch = round_up(camera.width, block_pixels);
    table.first_pixel = tables.padded_pixels;
    table.first_index = tables.pixels;
    tables.padded_pixels += std::uint64_t{table.pitch} * table.height;
    tables.pixels += pixel_count(camera);
  }
  if (tables.padded_pixels > most_pixels) {
    throw bad_usage(fmt::format("the cameras have {} pixels together; at most {} are supported", tables.padded_pixels,
                                most_pixels));
  }
  tables.rays.assign(tables.padded_pixels, glm::vec2(no_ray));
  if (std::ranges::any_of(tables.cameras, &CameraTable::background)) tables.limits.assign(tables.padded_pixels, 65535);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    CameraTable& table = tables.cameras[i];
    table.tiles_x = round_up(table.width, tile_pixels) / tile_pixels;
    table.tiles_y = round_up(table.height, tile_pixels) / tile_pixels;
    table.tiles.assign(std::size_t{table.tiles_x} * table.tiles_y, {});
    const std::span<glm::vec2> rays =
        std::span(tables.rays).subspan(table.first_pixel, std::size_t{table.pitch} * table.height);
    if (table.pinhole) {
      fill_pinhole_rays(table, rays);
    } else {
      fill_rays(cameras[i], table, rays);
    }
    table.tile_rows = bound_rows(table);
    if (!table.background) continue;
    for (std::uint32_t v = 0; v < table.height; ++v) {
      for (std::uint32_t u = 0; u < table.width; ++u) {
        tables.limits[table.first_pixel + std::size_t{v} * table.pitch + u] =
            nearer_than_background(cameras[i], std::size_t{v} * table.width + u);
      }
    }
  }
  return tables;
}

void plan_crops(std::span<const Camera> cameras, const RayTables& tables, const Box& box, std::vector<Crop>& crops) {
  crops.clear();
  if (box.empty()) return;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i];
    const CameraTable& table = tables.cameras[i];
    const std::uint32_t first_depth = first_valid_depth(camera);
    if (first_depth > 65535) continue;
    // Half a depth step nearer than any data, so that the clipped part holds no data.
    const Outline seen = outline(camera, grown(camera, box), (first_depth - 0.5) * camera.depth_unit_m);
    if (seen.empty()) continue;

    // Rays and depths are also floats.
    constexpr double slack = 1e-6;
    const double scale =
        1 + std::max({std::abs(seen.low.x), std::abs(seen.low.y), std::abs(seen.high.x), std::abs(seen.high.y)});
    const Vec2 grow(slack * scale);
    const TileRange tiles = find_tiles(table, glm::vec2(seen.low - grow), glm::vec2(seen.high + grow));
    if (tiles.empty()) continue;
    const double low = std::floor((seen.near * (1 - slack) - slack) / camera.depth_unit_m) - 1;
    const double high = std::ceil((seen.far * (1 + slack) + slack) / camera.depth_unit_m) + 1;

    Crop crop;
    crop.camera = static_cast<std::uint32_t>(i);
    crop.first_column = tiles.x0 * tile_pixels;
    crop.first_row = tiles.y0 * tile_pixels;
    const std::uint32_t end_column = std::min((tiles.x1 + 1) * tile_pixels, table.pitch);
    crop.blocks_per_row = (end_column - crop.first_column) / block_pixels;
    crop.rows = std::min((tiles.y1 + 1) * tile_pixels, table.height) - crop.first_row;
    crop.depth_low = static_cast<std::uint32_t>(std::clamp(low, static_cast<double>(first_depth), 65536.0));
    crop.depth_high = static_cast<std::uint32_t>(std::clamp(high, 0.0, 65535.0));
    if (crop.depth_low > crop.depth_high) continue;  // so both fit 16 bits
    crop.depth_unit = static_cast<float>(camera.depth_unit_m);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        crop.rows_of_pose[row][column] = static_cast<float>(camera.T_world_camera[column][row]);
      }
    }
    crops.push_back(crop);
  }
}

void check_frames(const RayTables& tables, std::span<const DepthFrame> frames) {
  if (frames.size() != tables.cameras.size()) {
    throw bad_usage(
        fmt::format("{} for {}", counted(frames.size(), "depth frame"), counted(tables.cameras.size(), "camera")));
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const CameraTable& table = tables.cameras[i];
    if (frames[i].depth.size() != std::size_t{table.width} * table.height) {
      throw bad_usage(fmt::format("depth frame {} has {} pixels, but its camera has {}x{}", i, frames[i].depth.size(),
                                  table.width, table.height));
    }
  }
}

void pack_depth(const RayTables& tables, std::span<const DepthFrame> frames, std::span<std::uint16_t> packed) {
  check_frames(tables, frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const CameraTable& table = tables.cameras[i];
    const std::vector<std::uint16_t>& depth = frames[i].depth;
    std::uint16_t* out = packed.data() + table.first_pixel;
    if (table.pitch == table.width) {
      std::memcpy(out, depth.data(), depth.size() * sizeof(std::uint16_t));
      continue;
    }
    for (std::uint32_t v = 0; v < table.height; ++v, out += table.pitch) {
      std::copy_n(depth.data() + std::size_t{v} * table.width, table.width, out);
      std::fill(out + table.width, out + table.pitch, std::uint16_t{0});
    }
  }
}

std::uint64_t count_valid(std::span<const Camera> cameras, std::span<const DepthFrame> frames) {
  std::uint64_t valid = 0;
  for (std::size_t i = 0; i < std::min(cameras.size(), frames.size()); ++i) {
    const Camera& camera = cameras[i];
    const std::uint32_t first = first_valid_depth(camera);
    const std::vector<std::uint16_t>& depth = frames[i].depth;
    for (std::uint32_t pixel = 0; pixel < std::min<std::uint64_t>(depth.size(), pixel_count(camera)); ++pixel)
      valid += depth[pixel] >= first && !is_ignored(camera, pixel % camera.width, pixel / camera.width) &&
               depth[pixel] <= nearer_than_background(camera, pixel);
  }
  return valid;
}

}  // namespace palpa::sensing
