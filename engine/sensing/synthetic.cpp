#include "sensing/synthetic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "sensing/depth_noise.hpp"

namespace palpa::sensing {
namespace {

struct Triangle {
  Vec3 a, b, c;  // camera coordinates
};

/// Edge functions of a triangle over ray directions (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous
/// Coordinates", 1997): no clipping, exact under any lens, and neighbours share their edge's value up to the sign, so
/// that a closed mesh has no cracks.
struct Edges {
  std::array<Vec3, 3> edge;
  double determinant = 0;
  double per_normal = 0;

  explicit Edges(const Triangle& t) : edge{glm::cross(t.b, t.c), glm::cross(t.c, t.a), glm::cross(t.a, t.b)} {
    determinant = glm::dot(t.a, edge[0]);
    const double length = glm::length(edge[0] + edge[1] + edge[2]);
    per_normal = length > 0 ? 1 / length : 0;
    if (determinant < 0) {  // seen from behind: same test with all signs turned
      determinant = -determinant;
      for (Vec3& e : edge)
        e = -e;
    }
  }
  bool visible() const { return determinant > 0 && per_normal > 0; }
};

double along(const Vec3& edge, double x, double y) {
  return edge.x * x + edge.y * y + edge.z;
}

/// Columns and rows, ends excluded.
struct PixelRange {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

std::uint32_t clamp_pixel(double value, std::uint32_t size) {
  return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(size)));
}

}  // namespace

SyntheticRig::SyntheticRig(std::vector<Camera> cameras, const geometry::Mesh& occluders, Noise noise,
                           std::uint64_t seed)
    : cameras_(std::move(cameras)), tables_(make_rays(cameras_)), still_(cameras_.size()), noise_(noise), seed_(seed) {
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    still_[i].depth.assign(pixel_count(cameras_[i]), beyond);
    still_[i].slant.assign(pixel_count(cameras_[i]), 0);
    draw(i, occluders, Transform(1.0), still_[i]);
  }
}

void SyntheticRig::draw(std::size_t index, const geometry::Mesh& mesh, const Transform& T_world_mesh, Layer& layer) {
  const Camera& camera = cameras_[index];
  const CameraTable& table = tables_.cameras[index];
  const glm::vec2* rays = tables_.rays.data() + table.first_pixel;
  const Transform T_camera_mesh = glm::inverse(camera.T_world_camera) * T_world_mesh;
  corners_.resize(mesh.positions.size());
  std::transform(mesh.positions.begin(), mesh.positions.end(), corners_.begin(),
                 [&](const Vec3& p) { return transform_point(T_camera_mesh, p); });

  const auto draw_range = [&](const Edges& edges, const PixelRange& range) {
    const auto& [e0, e1, e2] = edges.edge;
    for (std::uint32_t v = range.y0; v < range.y1; ++v) {
      const glm::vec2* ray_row = rays + std::size_t{v} * table.pitch;
      float* depth_row = layer.depth.data() + std::size_t{v} * table.width;
      float* slant_row = layer.slant.data() + std::size_t{v} * table.width;
      for (std::uint32_t u = range.x0; u < range.x1; ++u) {
        const double x = ray_row[u].x, y = ray_row[u].y;
        const double a = along(e0, x, y), b = along(e1, x, y), c = along(e2, x, y);
        if (a < 0 || b < 0 || c < 0) continue;
        const double sum = a + b + c;
        const double z = edges.determinant / sum;
        // A ray within the triangle's own plane has a sum of 0; a pixel without a ray has a huge one and no depth.
        if (!(z < depth_row[u]) || !(z > 1e-6)) continue;
        depth_row[u] = static_cast<float>(z);
        slant_row[u] = static_cast<float>(sum * edges.per_normal);
      }
    }
  };

  for (const glm::uvec3& corner : mesh.triangles) {
    const Triangle t{corners_[corner.x], corners_[corner.y], corners_[corner.z]};
    const auto [near, far] = std::minmax({t.a.z, t.b.z, t.c.z});
    if (far <= 0) continue;
    const Edges edges(t);
    if (!edges.visible()) continue;
    if (near < 1e-6) {  // reaches behind the camera: no bounds
      draw_range(edges, {0, 0, table.width, table.height});
      continue;
    }
    const auto [low_x, high_x] = std::minmax({t.a.x / t.a.z, t.b.x / t.b.z, t.c.x / t.c.z});
    const auto [low_y, high_y] = std::minmax({t.a.y / t.a.z, t.b.y / t.b.z, t.c.y / t.c.z});
    if (table.pinhole) {
      // One pixel of slack for the rounding of rays.
      draw_range(edges, {clamp_pixel(std::floor(low_x * camera.fx + camera.cx) - 1, table.width),
                         clamp_pixel(std::floor(low_y * camera.fy + camera.cy) - 1, table.height),
                         clamp_pixel(std::ceil(high_x * camera.fx + camera.cx) + 2, table.width),
                         clamp_pixel(std::ceil(high_y * camera.fy + camera.cy) + 2, table.height)});
      continue;
    }
    for (std::uint32_t ty = 0; ty < table.tiles_y; ++ty) {
      const RayBounds& row = table.tile_rows[ty];
      if (row.low.x > high_x || row.high.x < low_x || row.low.y > high_y || row.high.y < low_y) continue;
      for (std::uint32_t tx = 0; tx < table.tiles_x; ++tx) {
        const RayBounds& tile = table.tiles[std::size_t{ty} * table.tiles_x + tx];
        if (tile.low.x > high_x || tile.high.x < low_x || tile.low.y > high_y || tile.high.y < low_y) continue;
        draw_range(edges, {tx * tile_pixels, ty * tile_pixels, std::min((tx + 1) * tile_pixels, table.width),
                           std::min((ty + 1) * tile_pixels, table.height)});
      }
    }
  }
}

void SyntheticRig::render(std::span<const Posed> skin, std::uint64_t sequence, FrameSet& out) {
  out.frames.resize(cameras_.size());
  out.sequence = sequence;
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    work_.depth = still_[i].depth;  // keeps work_'s storage
    work_.slant = still_[i].slant;
    for (const Posed& posed : skin)
      draw(i, *posed.mesh, posed.T_world_mesh, work_);
    const DepthImage image{cameras_[i], work_.depth, work_.slant,
                           std::span(tables_.rays).subspan(tables_.cameras[i].first_pixel), tables_.cameras[i].pitch};
    if (noise_ == Noise::none) {
      quantize(image, out.frames[i].depth);
    } else {
      noise_maker_.apply(image, noise_key(seed_, sequence, i), out.frames[i].depth);
    }
  }
}

}  // namespace palpa::sensing
