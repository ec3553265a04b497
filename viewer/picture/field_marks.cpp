#include "viewer/picture/field_marks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "array/schedule.hpp"
#include "viewer/picture/palette.hpp"

namespace palpa::viewer {
namespace {

void replace_bar(Picture& picture, ColourBar bar) {
  std::erase_if(picture.bars, [&](const ColourBar& other) { return other.layer == bar.layer; });
  picture.bars.push_back(std::move(bar));
}

ColourBar* bar_of(Picture& picture, Layer layer) {
  const auto bar = std::ranges::find(picture.bars, layer, &ColourBar::layer);
  return bar == picture.bars.end() ? nullptr : &*bar;
}

}  // namespace

double round_up(double most) {
  if (!(most > 1e-9) || most > 1e12) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(most) + 1e-9)), mantissa = most / power;
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0}) {
    if (mantissa <= step * (1 + 1e-9)) return power * step;
  }
  return power * 10;
}

SliceGrid slice_grid(const SliceState& slice, std::uint32_t along) {
  const double longer = std::max(slice.size_m.x, slice.size_m.y);
  const auto count = [&](double size) {
    return std::max(2U, static_cast<std::uint32_t>(std::lround(along * size / longer)));
  };
  return {count(slice.size_m.x), count(slice.size_m.y)};
}

std::vector<Vec3> slice_points(const SliceState& slice, const SliceGrid& grid) {
  std::vector<Vec3> points;
  points.reserve(std::size_t{grid.columns} * grid.rows);
  for (std::uint32_t j = 0; j < grid.rows; ++j) {
    for (std::uint32_t i = 0; i < grid.columns; ++i) {
      const Vec2 part((i + 0.5) / grid.columns - 0.5, 0.5 - (j + 0.5) / grid.rows);
      points.push_back(transform_point(slice.T_world_slice, Vec3(part * slice.size_m, 0)));
    }
  }
  return points;
}

void show_slice(Picture& picture, const SliceState& slice, const SliceGrid& grid,
                std::span<const std::complex<double>> pressures) {
  double peak = 0;
  for (const std::complex<double>& p : pressures)
    peak = std::max(peak, std::abs(p));
  const bool linear = peak <= array::linear_pressure_pa;
  const double most = linear ? round_up(peak) : peak;

  std::erase_if(picture.images, [](const ImageMark& image) { return image.layer == Layer::slice; });
  ImageMark& image = picture.images.emplace_back();
  image.layer = Layer::slice;
  image.width = grid.columns;
  image.height = grid.rows;
  const Vec2 half = 0.5 * slice.size_m;
  const std::array<Vec2, 4> corners{Vec2(-half.x, half.y), half, Vec2(half.x, -half.y), -half};
  for (std::size_t i = 0; i < 4; ++i)
    image.corners[i] = glm::vec3(transform_point(slice.T_world_slice, Vec3(corners[i], 0)));
  image.pixels.reserve(pressures.size());
  for (const std::complex<double>& p : pressures)
    image.pixels.push_back(to_pixel(drawing::map_colour(std::abs(p) / most)));
  replace_bar(picture,
              {Layer::slice,
               linear ? "sound pressure in the plane, Pa peak"
                      : fmt::format("sound pressure in the plane, of {:.1f} kPa: beyond linear acoustics", peak / 1e3),
               linear ? most : 1});
}

void show_heat(Picture& picture, std::string name, geometry::Mesh body, std::span<const double> values,
               const std::string& title) {
  double peak = 0;
  for (const double value : values)
    peak = std::max(peak, std::isnan(value) ? 0 : value);
  const double most = round_up(peak);
  SurfaceMark skin{std::move(name), std::move(body), {}, {}};
  skin.colours.reserve(values.size());
  for (const double value : values)
    skin.colours.push_back(drawing::map_colour(value / most));
  picture.skin = std::move(skin);
  replace_bar(picture, {Layer::heat, title, most});
}

bool hide_bar(Picture& picture, Layer layer) {
  return std::erase_if(picture.bars, [&](const ColourBar& bar) { return bar.layer == layer; }) > 0;
}

bool hide_slice(Picture& picture) {
  const bool images = std::erase_if(picture.images, [](const ImageMark& image) { return image.layer == Layer::slice; });
  return hide_bar(picture, Layer::slice) || images;
}

bool mark(Picture& picture, Layer layer, const std::string& title, Standing standing, const std::string& progress) {
  ColourBar* const bar = bar_of(picture, layer);
  const bool shown = bar != nullptr && bar->most > 0;
  if (standing == Standing::fresh && !shown) return hide_bar(picture, layer);
  const std::string next = standing == Standing::stale ? progress : std::string();
  if (bar == nullptr) {
    picture.bars.push_back({layer, title, 0, standing, next});
    return true;
  }
  const bool same = bar->standing == standing && bar->progress == next;
  bar->standing = standing;
  bar->progress = next;
  return !same;
}

std::string note_of(const ColourBar& bar) {
  if (bar.standing == Standing::fresh) return {};
  if (bar.standing == Standing::failed) return "failed";
  return (bar.most > 0 ? "stale" : "being computed") + bar.progress;
}

bool is_stale(const Picture& picture, Layer layer) {
  const auto bar = std::ranges::find(picture.bars, layer, &ColourBar::layer);
  return bar != picture.bars.end() && bar->standing != Standing::fresh;
}

}  // namespace palpa::viewer
