#include "sensing/synthetic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <iterator>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sensing/depth_noise.hpp"
#include "sensing/hierarchical_z.hpp"
#include "sensing/triangle_edges.hpp"

namespace palpa::sensing {
namespace {

/// From this many rays per pixel of an image, triangles are drawn by hierarchical_z.hpp, which costs more per triangle.
constexpr std::uint64_t rays_before_hierarchy = 16;
/// Maximum number of rays: per pixel of an image, or for the pictures of all cameras if that is more; and per triangle.
constexpr std::uint64_t most_looks_per_pixel = 64, most_looks = std::uint64_t{1} << 27, most_looks_per_triangle = 1000;

/// The pixels between two positions on an image's axis, plus those that the rounding of rays could bring there.
RowSpan between(double low, double high, std::uint32_t size) {
  constexpr double rounding = 1.0 / 64;
  const double last = static_cast<double>(size);
  return {static_cast<std::uint32_t>(std::clamp(std::ceil(low - rounding), 0.0, last)),
          static_cast<std::uint32_t>(std::clamp(std::floor(high + rounding) + 1, 0.0, last))};
}

}  // namespace

void SyntheticRig::Layer::copy(const Layer& from, const PixelBox& box, std::uint32_t width) {
  for (std::uint32_t v = box.y0; v < box.y1; ++v) {
    const std::size_t first = std::size_t{v} * width + box.x0, count = box.x1 - box.x0;
    std::copy_n(from.depth.data() + first, count, depth.data() + first);
    std::copy_n(from.slant.data() + first, count, slant.data() + first);
    if (!risks.empty()) std::copy_n(from.risks.data() + first, count, risks.data() + first);
  }
}

/// The same cameras without ignored pixels: a camera also sees what it is told to ignore.
static std::vector<Camera> seeing_all(std::vector<Camera> cameras) {
  for (Camera& camera : cameras)
    see_all(camera);
  return cameras;
}

SyntheticRig::SyntheticRig(std::vector<Camera> cameras, const geometry::Mesh& occluders, Noise noise,
                           std::uint64_t seed, const std::string& occluders_name)
    : cameras_(std::move(cameras)),
      tables_(make_rays(seeing_all(cameras_))),
      images_(cameras_.size()),
      noise_(noise),
      seed_(seed) {
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    Layer& still = images_[i].still;
    still.depth.assign(pixel_count(cameras_[i]), beyond);
    still.slant.assign(pixel_count(cameras_[i]), 0);
    draw(i, occluders, Transform(1.0), occluders_name, still);
    if (noise_ == Noise::d415) finish_still(i);
    images_[i].shown = still;
  }
}

DepthImage SyntheticRig::image(std::size_t index, const Layer& layer) const {
  const CameraTable& table = tables_.cameras[index];
  return {cameras_[index], layer.depth, layer.slant, std::span(tables_.rays).subspan(table.first_pixel), table.pitch};
}

void SyntheticRig::finish_still(std::size_t index) {
  CameraImages& images = images_[index];
  const std::uint32_t width = cameras_[index].width, height = cameras_[index].height;
  images.still.risks.resize(images.still.depth.size());
  find_risks(image(index, images.still), {0, 0, width, height}, images.still.risks);
  for (std::uint32_t v = 0; v < height; ++v) {
    const auto row = images.still.depth.begin() + static_cast<std::ptrdiff_t>(std::size_t{v} * width);
    const auto seen = [](float z) { return z != beyond; };
    const auto first = std::find_if(row, row + width, seen);
    const auto last = std::find_if(std::reverse_iterator(row + width), std::reverse_iterator(first), seen).base();
    images.still_spans.push_back({static_cast<std::uint32_t>(first - row), static_cast<std::uint32_t>(last - row)});
  }
  images.spans = images.still_spans;
}

/// A mesh drawn into one camera's layer.
struct SyntheticRig::Drawing {
  const Camera& camera;
  const CameraTable& table;
  const glm::vec2* rays;
  Layer& layer;
  PixelBox drawn{};
  std::uint64_t looks = 0;
  std::vector<PlacedTriangle> late{};  ///< triangles that come after too many rays have been cast

  /// A triangle, and the bounds of the rays to its corners.
  struct Bounded {
    TriangleEdges edges;
    Vec2 low, high;
    double near;
    bool is_late;
  };

  void draw(const Corner& a, const Corner& b, const Corner& c) {
    const auto [near, far] = std::minmax({a.position.z, b.position.z, c.position.z});
    if (far <= 0) return;
    const bool is_late = looks > rays_before_hierarchy * pixel_count(camera);
    const bool behind = near < 1e-6;  // reaches behind the camera, so has no bounds
    const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x});
    const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
    PixelBox box{0, 0, table.width, table.height};
    if (table.pinhole && !behind) {
      box = pinhole_box({low_x, low_y}, {high_x, high_y});
      if (box.empty()) return;
    }
    const Bounded triangle{
        TriangleEdges(a.position, b.position, c.position), {low_x, low_y}, {high_x, high_y}, near, is_late};
    if (!triangle.edges.visible()) return;
    if (!table.pinhole && !behind) {
      draw_in_tiles(triangle);
    } else if (is_late) {
      drawn = around(drawn, box);
      late.push_back({.edges = triangle.edges, .box = box, .near = near});
    } else {
      draw_in_box(triangle.edges, box);
    }
  }

  /// A fine mesh has many triangles between the pixels' centres; their boxes are empty.
  PixelBox pinhole_box(const Vec2& low, const Vec2& high) const {
    const RowSpan columns = between(low.x * camera.fx + camera.cx, high.x * camera.fx + camera.cx, table.width);
    const RowSpan rows = between(low.y * camera.fy + camera.cy, high.y * camera.fy + camera.cy, table.height);
    return {columns.begin, rows.begin, columns.end, rows.end};
  }

  /// In those tiles of a picture with a distorting lens that have such rays.
  void draw_in_tiles(const Bounded& triangle) {
    const auto misses = [&](const RayBounds& bounds) {
      return bounds.low.x > triangle.high.x || bounds.high.x < triangle.low.x || bounds.low.y > triangle.high.y ||
             bounds.high.y < triangle.low.y;
    };
    PixelBox tiles;
    for (std::uint32_t ty = 0; ty < table.tiles_y; ++ty) {
      if (misses(table.tile_rows[ty])) continue;
      for (std::uint32_t tx = 0; tx < table.tiles_x; ++tx) {
        if (misses(table.tiles[std::size_t{ty} * table.tiles_x + tx])) continue;
        const PixelBox here{tx * tile_pixels, ty * tile_pixels, std::min((tx + 1) * tile_pixels, table.width),
                            std::min((ty + 1) * tile_pixels, table.height)};
        if (triangle.is_late) {
          tiles = around(tiles, here);
        } else {
          draw_in_box(triangle.edges, here);
        }
      }
    }
    if (tiles.empty()) return;
    drawn = around(drawn, tiles);
    late.push_back({triangle.edges, tiles, triangle.low, triangle.high, triangle.near});
  }

  void draw_in_box(const TriangleEdges& edges, const PixelBox& box) {
    drawn = around(drawn, box);
    looks += std::uint64_t{box.x1 - box.x0} * (box.y1 - box.y0);
    for (std::uint32_t v = box.y0; v < box.y1; ++v) {
      const glm::vec2* ray_row = rays + std::size_t{v} * table.pitch;
      float* depth_row = layer.depth.data() + std::size_t{v} * table.width;
      float* slant_row = layer.slant.data() + std::size_t{v} * table.width;
      for (std::uint32_t u = box.x0; u < box.x1; ++u) {
        RayHit hit;
        if (!meets(edges, ray_row[u].x, ray_row[u].y, hit) || !(hit.depth < depth_row[u])) continue;
        depth_row[u] = static_cast<float>(hit.depth);
        slant_row[u] = hit.slant;
      }
    }
  }

  /// False if it takes more than `most` looks.
  bool draw_late(std::uint64_t most) {
    return draw_hierarchical_z(table, rays, late, layer.depth, layer.slant, most, looks);
  }
};

PixelBox SyntheticRig::draw(std::size_t index, const geometry::Mesh& mesh, const Transform& T_world_mesh,
                            const std::string& name, Layer& layer) {
  const Camera& camera = cameras_[index];
  const CameraTable& table = tables_.cameras[index];
  const Transform T_camera_mesh = glm::inverse(camera.T_world_camera) * T_world_mesh;
  corners_.resize(mesh.positions.size());
  std::transform(mesh.positions.begin(), mesh.positions.end(), corners_.begin(), [&](const Vec3& p) {
    const Vec3 at = transform_point(T_camera_mesh, p);
    return Corner{at, at.x / at.z, at.y / at.z};
  });
  Drawing drawing{camera, table, tables_.rays.data() + table.first_pixel, layer};
  for (const glm::uvec3& corner : mesh.triangles)
    drawing.draw(corners_[corner.x], corners_[corner.y], corners_[corner.z]);
  const std::uint64_t most = std::max(most_looks / cameras_.size(), most_looks_per_pixel * pixel_count(camera)) +
                             most_looks_per_triangle * mesh.triangles.size();
  if (!drawing.draw_late(most)) {
    throw bad_input(name,
                    fmt::format("camera \"{}\" sees so many of its triangles behind each other that a picture takes "
                                "more than {} million rays; leave out surfaces inside the mesh or on top of each other",
                                printable(camera.name, 60), most / 1'000'000));
  }
  return drawing.drawn;
}

void SyntheticRig::show(std::size_t index, std::span<const Posed> skin) {
  CameraImages& images = images_[index];
  const std::uint32_t width = cameras_[index].width, height = cameras_[index].height;
  const auto risky = [&](const PixelBox& box) { return grown(box, D415::rim_px, width, height); };
  const PixelBox before = risky(images.skin);
  images.shown.copy(images.still, before, width);
  images.skin = {};
  for (const Posed& posed : skin)
    images.skin = around(images.skin, draw(index, *posed.mesh, posed.T_world_mesh, posed.name, images.shown));
  if (noise_ == Noise::none) return;
  find_risks(image(index, images.shown), risky(images.skin), images.shown.risks);
  std::copy(images.still_spans.begin() + before.y0, images.still_spans.begin() + before.y1,
            images.spans.begin() + before.y0);
  for (std::uint32_t v = images.skin.y0; v < images.skin.y1; ++v) {
    RowSpan& span = images.spans[v];
    const bool alone = span.begin >= span.end;
    span = {alone ? images.skin.x0 : std::min(span.begin, images.skin.x0),
            alone ? images.skin.x1 : std::max(span.end, images.skin.x1)};
  }
}

void SyntheticRig::render(std::span<const Posed> skin, std::uint64_t sequence, FrameSet& out) {
  out.frames.resize(cameras_.size());
  out.sequence = sequence;
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    show(i, skin);
    const CameraImages& images = images_[i];
    if (noise_ == Noise::none) {
      quantize(image(i, images.shown), out.frames[i].depth);
    } else {
      noise_maker_.apply(image(i, images.shown), images.shown.risks, images.spans, noise_key(seed_, sequence, i),
                         out.frames[i].depth);
    }
  }
}

}  // namespace palpa::sensing
