#include "sensing/hierarchical_z.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace palpa::sensing {
namespace {

constexpr std::uint32_t tiles_per_block = 8;
constexpr std::uint32_t before = 0xffffffffu;  // drawn before the first triangle

/// A box of the tree: a tile, or a block of tiles.
struct Region {
  RayBounds rays;
  float farthest = 0;  ///< the farthest depth drawn so far
};

/// State that decides which triangle is visible at a pixel. If triangles are drawn one after the other, the last one
/// wins whose depth is below the rounded one, which is the minimum of all; if there is none, the first one that rounds
/// to it.
struct Seen {
  std::uint32_t triangle = before;
  bool below = false;
};

/// Upper bound of the edge function for all rays inside. Rounding keeps the order of products and sums.
double most_along(const Vec3& edge, const RayBounds& rays) {
  return along(edge, edge.x > 0 ? rays.high.x : rays.low.x, edge.y > 0 ? rays.high.y : rays.low.y);
}

class HierarchicalZ {
 public:
  HierarchicalZ(const CameraTable& table, const glm::vec2* rays, std::span<const PlacedTriangle> triangles,
                std::span<float> depth, std::span<float> slant)
      : table_(table),
        rays_(rays),
        triangles_(triangles),
        depth_(depth),
        slant_(slant),
        seen_(depth.size()),
        blocks_x_((table.tiles_x + tiles_per_block - 1) / tiles_per_block),
        tiles_(table.tiles.size()),
        blocks_(std::size_t{blocks_x_} * ((table.tiles_y + tiles_per_block - 1) / tiles_per_block)) {
    for (std::uint32_t ty = 0; ty < table.tiles_y; ++ty) {
      for (std::uint32_t tx = 0; tx < table.tiles_x; ++tx) {
        Region& tile = tiles_[std::size_t{ty} * table.tiles_x + tx];
        tile.rays = table.tiles[std::size_t{ty} * table.tiles_x + tx];
        tile.farthest = farthest_in(tx, ty);
        Region& block = block_of(tx, ty);
        block.rays.low = glm::min(block.rays.low, tile.rays.low);
        block.rays.high = glm::max(block.rays.high, tile.rays.high);
        block.farthest = std::max(block.farthest, tile.farthest);
      }
    }
  }

  bool draw(std::uint64_t most, std::uint64_t& looks) {
    std::vector<std::uint32_t> order(triangles_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return triangles_[i].near; });
    for (const std::uint32_t i : order) {
      draw(i, looks);
      if (looks > most) return false;
    }
    return true;
  }

 private:
  Region& block_of(std::uint32_t tx, std::uint32_t ty) {
    return blocks_[std::size_t{ty / tiles_per_block} * blocks_x_ + tx / tiles_per_block];
  }

  PixelBox pixels_of(std::uint32_t tx, std::uint32_t ty) const {
    return {tx * tile_pixels, ty * tile_pixels, std::min((tx + 1) * tile_pixels, table_.width),
            std::min((ty + 1) * tile_pixels, table_.height)};
  }

  float farthest_in(std::uint32_t tx, std::uint32_t ty) const {
    const PixelBox box = pixels_of(tx, ty);
    float farthest = 0;
    for (std::uint32_t v = box.y0; v < box.y1; ++v) {
      const auto row = depth_.subspan(std::size_t{v} * table_.width);
      farthest = std::max(farthest, *std::max_element(row.begin() + box.x0, row.begin() + box.x1));
    }
    return farthest;
  }

  /// Whether no ray of the region can show the triangle: all miss it, or meet it behind what is drawn there.
  static bool hides(const Region& region, const TriangleEdges& t) {
    Vec3 most(0);
    for (int k = 0; k < 3; ++k) {
      most[k] = most_along(t.edge[static_cast<std::size_t>(k)], region.rays);
      if (most[k] < 0) return true;
    }
    // The sum of the edges is largest where the depth is smallest, and at most the sum of the individual maxima.
    // Computing it at once gives a tighter bound, up to the rounding of either.
    const Vec3 normal = t.edge[0] + t.edge[1] + t.edge[2];
    const glm::vec2 reach = glm::max(glm::abs(region.rays.low), glm::abs(region.rays.high));
    double size = 0;
    for (const Vec3& e : t.edge)
      size += std::abs(e.x) * reach.x + std::abs(e.y) * reach.y + std::abs(e.z);
    const double sum = std::min(most[0] + most[1] + most[2], most_along(normal, region.rays) + 1e-14 * size);
    return static_cast<float>(t.determinant / sum) > region.farthest;
  }

  void draw(std::uint32_t index, std::uint64_t& looks) {
    const PlacedTriangle& t = triangles_[index];
    const std::uint32_t x0 = t.box.x0 / tile_pixels, x1 = (t.box.x1 + tile_pixels - 1) / tile_pixels;
    const std::uint32_t y0 = t.box.y0 / tile_pixels, y1 = (t.box.y1 + tile_pixels - 1) / tile_pixels;
    for (std::uint32_t by = y0 / tiles_per_block; by * tiles_per_block < y1; ++by) {
      for (std::uint32_t bx = x0 / tiles_per_block; bx * tiles_per_block < x1; ++bx) {
        Region& block = block_of(bx * tiles_per_block, by * tiles_per_block);
        if (hides(block, t.edges)) continue;
        bool nearer = false;
        for (std::uint32_t ty = std::max(y0, by * tiles_per_block); ty < std::min(y1, (by + 1) * tiles_per_block);
             ++ty) {
          for (std::uint32_t tx = std::max(x0, bx * tiles_per_block); tx < std::min(x1, (bx + 1) * tiles_per_block);
               ++tx)
            nearer |= draw_tile(index, tx, ty, looks);
        }
        if (nearer) settle(bx, by, block);
      }
    }
  }

  void settle(std::uint32_t bx, std::uint32_t by, Region& block) const {
    block.farthest = 0;
    for (std::uint32_t ty = by * tiles_per_block; ty < std::min(table_.tiles_y, (by + 1) * tiles_per_block); ++ty) {
      for (std::uint32_t tx = bx * tiles_per_block; tx < std::min(table_.tiles_x, (bx + 1) * tiles_per_block); ++tx)
        block.farthest = std::max(block.farthest, tiles_[std::size_t{ty} * table_.tiles_x + tx].farthest);
    }
  }

  /// Draws the triangle in a tile; returns whether the tile's farthest depth became nearer.
  bool draw_tile(std::uint32_t index, std::uint32_t tx, std::uint32_t ty, std::uint64_t& looks) {
    const PlacedTriangle& t = triangles_[index];
    Region& tile = tiles_[std::size_t{ty} * table_.tiles_x + tx];
    if (tile.rays.low.x > t.high.x || tile.rays.high.x < t.low.x || tile.rays.low.y > t.high.y ||
        tile.rays.high.y < t.low.y || hides(tile, t.edges))
      return false;
    const PixelBox all = pixels_of(tx, ty);
    const PixelBox box{std::max(all.x0, t.box.x0), std::max(all.y0, t.box.y0), std::min(all.x1, t.box.x1),
                       std::min(all.y1, t.box.y1)};
    if (box.empty()) return false;
    looks += std::uint64_t{box.x1 - box.x0} * (box.y1 - box.y0);
    bool replaced_farthest = false;
    for (std::uint32_t v = box.y0; v < box.y1; ++v) {
      for (std::uint32_t u = box.x0; u < box.x1; ++u) {
        const glm::vec2& ray = rays_[std::size_t{v} * table_.pitch + u];
        RayHit hit;
        if (!meets(t.edges, ray.x, ray.y, hit)) continue;
        const std::size_t pixel = std::size_t{v} * table_.width + u;
        const float was = depth_[pixel];
        if (!take(index, hit, pixel)) continue;
        replaced_farthest |= was == tile.farthest;
      }
    }
    if (!replaced_farthest) return false;
    const float was = tile.farthest;
    tile.farthest = farthest_in(tx, ty);
    return tile.farthest < was;
  }

  bool take(std::uint32_t index, const RayHit& hit, std::size_t pixel) {
    const auto rounded = static_cast<float>(hit.depth);
    const bool below = hit.depth < rounded;
    Seen& seen = seen_[pixel];
    if (!(rounded < depth_[pixel])) {
      if (!(rounded == depth_[pixel])) return false;
      const bool wins = below ? !seen.below || index > seen.triangle
                              : !seen.below && seen.triangle != before && index < seen.triangle;
      if (!wins) return false;
    }
    seen = {index, below};
    depth_[pixel] = rounded;
    slant_[pixel] = hit.slant;
    return true;
  }

  const CameraTable& table_;
  const glm::vec2* rays_;
  std::span<const PlacedTriangle> triangles_;
  std::span<float> depth_, slant_;
  std::vector<Seen> seen_;
  std::uint32_t blocks_x_;
  std::vector<Region> tiles_, blocks_;
};

}  // namespace

bool draw_hierarchical_z(const CameraTable& table, const glm::vec2* rays, std::span<const PlacedTriangle> triangles,
                         std::span<float> depth, std::span<float> slant, std::uint64_t most, std::uint64_t& looks) {
  return triangles.empty() || HierarchicalZ(table, rays, triangles, depth, slant).draw(most, looks);
}

}  // namespace palpa::sensing
