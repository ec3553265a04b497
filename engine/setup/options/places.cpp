#include "setup/options/places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/system/memory.hpp"
#include "base/units.hpp"
#include "geometry/files/ply.hpp"
#include "line/together.hpp"
#include "line/values.hpp"

namespace palpa::setup {
namespace {

constexpr double farthest_m = 100;
constexpr std::uint32_t most_pixels = 65536;   // on a side
constexpr std::uint32_t default_pixels = 256;  // on the longer side
constexpr std::uint32_t default_samples = 201;
/// Memory per point until its results are written: its position, its pressure, and both as text.
constexpr std::uint64_t bytes_per_point = 160;

void check_room(std::uint64_t points) {
  require_memory(points * bytes_per_point, fmt::format("a field of {} points", points), "give fewer points");
}

Vec3 parse_place(const char* option, const std::string& text) {
  const auto [x, y, z] = line::parse_point(option, text);
  if (std::max({std::abs(x), std::abs(y), std::abs(z)}) > farthest_m)
    throw bad_usage(fmt::format("{}: '{}' is farther than {} m away", option, text, farthest_m));
  return {x, y, z};
}

/// The two parts of "a,b"; empty if there are more or fewer parts.
std::optional<std::pair<std::string_view, std::string_view>> halves(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find(',', comma + 1) != std::string_view::npos) return {};
  return std::pair(text.substr(0, comma), text.substr(comma + 1));
}

Vec2 parse_size(const std::string& text) {
  if (text.empty()) throw bad_usage("--plane has no extent: give --size W,H, such as 60mm,60mm");
  const auto parts = halves(text);
  const auto length = [](std::string_view part) { return parse_quantity(part, Quantity::length).value_or(0); };
  const Vec2 size = parts ? Vec2(length(parts->first), length(parts->second)) : Vec2(0);
  if (!(size.x > 0 && size.y > 0 && std::max(size.x, size.y) <= farthest_m)) {
    throw bad_usage(fmt::format("--size: '{}' is not W,H with both above 0, at most {} m, such as 60mm,60mm",
                                text.substr(0, 60), farthest_m));
  }
  return size;
}

std::uint32_t parse_pixel_count(std::string_view text) {
  const std::uint32_t count = parse_whole<std::uint32_t>(text).value_or(0);
  return count <= most_pixels ? count : 0;
}

void set_square_pixels(Grid& grid) {
  const double pixel = std::max(grid.size_m.x, grid.size_m.y) / default_pixels;
  const auto count = [&](double side) { return static_cast<std::uint32_t>(std::max(1.0, std::round(side / pixel))); };
  grid.columns = count(grid.size_m.x);
  grid.rows = count(grid.size_m.y);
}

void set_pixels(const std::string& text, Grid& grid) {
  if (const auto parts = halves(text)) {
    grid.columns = parse_pixel_count(parts->first);
    grid.rows = parse_pixel_count(parts->second);
  }
  if (grid.columns == 0 || grid.rows == 0) {
    throw bad_usage(fmt::format("--pixels: '{}' is not N,M with whole numbers from 1 to {}, such as 256,256",
                                text.substr(0, 60), most_pixels));
  }
}

Grid grid_of(const PlaceOptions& o) {
  Grid grid;
  grid.plane = *o.plane;
  grid.centre = o.centre.empty() ? Vec3(0) : parse_place("--centre", o.centre);
  grid.size_m = parse_size(o.size);
  if (!o.pixels.empty()) set_pixels(o.pixels, grid);
  return grid;
}

std::pair<Vec3, Vec3> ends_of(const PlaceOptions& o) {
  const Vec3 from = parse_place("--line", o.line[0]), to = parse_place("--line", o.line[1]);
  if (from == to) throw bad_usage("--line: both ends are the same point; give two");
  return {from, to};
}

/// Not a number: not near.
bool is_near(const Vec3& p) {
  return std::abs(p.x) <= farthest_m && std::abs(p.y) <= farthest_m && std::abs(p.z) <= farthest_m;
}

void check_near(const std::string& what, const Vec3& p) {
  if (is_near(p)) return;
  throw bad_usage(fmt::format("{} ({}, {}, {}) is not within {} m", what, p.x, p.y, p.z, farthest_m));
}

Places file_of(const PlaceOptions& o) {
  geometry::Ply ply = geometry::read_ply(o.points);
  if (ply.positions.empty()) throw bad_input(o.points, "has no points");
  check_room(ply.positions.size());
  for (std::size_t i = 0; i < ply.positions.size(); ++i) {
    const Vec3& p = ply.positions[i];
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > farthest_m)
      throw bad_input(o.points,
                      fmt::format("vertex {} is farther than {} m away; coordinates are metres", i, farthest_m));
  }
  Places places;
  places.points = std::move(ply.positions);
  places.triangles = std::move(ply.triangles);
  return places;
}

}  // namespace

Places plane_places(const Grid& given) {
  Grid grid = given;
  check_near("the plane's centre", grid.centre);
  if (!(grid.size_m.x > 0 && grid.size_m.y > 0 && std::max(grid.size_m.x, grid.size_m.y) <= farthest_m)) {
    throw bad_usage(fmt::format("the plane's size, {} by {} m, is not above 0 and at most {} m", grid.size_m.x,
                                grid.size_m.y, farthest_m));
  }
  if (grid.columns == 0 && grid.rows == 0) set_square_pixels(grid);
  if (std::min(grid.columns, grid.rows) == 0 || std::max(grid.columns, grid.rows) > most_pixels) {
    throw bad_usage(fmt::format("the plane's pixels, {} by {}, are not 1 to {} on each side", grid.columns, grid.rows,
                                most_pixels));
  }
  check_room(std::uint64_t{grid.columns} * grid.rows);

  const Vec3 right = grid.plane == Plane::yz ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
  const Vec3 up = grid.plane == Plane::xy ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  Places places;
  reserve_large(places.points, std::size_t{grid.columns} * grid.rows);
  for (std::uint32_t j = 0; j < grid.rows; ++j) {
    const Vec3 row = grid.centre + up * (grid.size_m.y * (0.5 - (j + 0.5) / grid.rows));
    for (std::uint32_t i = 0; i < grid.columns; ++i)
      places.points.push_back(row + right * (grid.size_m.x * ((i + 0.5) / grid.columns - 0.5)));
  }
  places.grid = grid;
  return places;
}

Places line_places(const Vec3& from, const Vec3& to, std::uint32_t samples) {
  check_near("the line's end", from);
  check_near("the line's end", to);
  if (from == to) throw bad_usage("both ends of the line are the same point; give two");
  if (samples < 2) throw bad_usage("a line needs at least 2 samples: give a larger --samples");
  check_room(samples);
  Places places;
  places.line = true;
  reserve_large(places.points, samples);
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / (samples - 1);
    places.points.push_back(from * (1 - t) + to * t);
  }
  return places;
}

Places point_places(std::vector<Vec3> points, std::vector<glm::uvec3> triangles) {
  if (points.empty()) throw bad_usage("there are no points to look at");
  check_room(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_near(points[i])) check_near(fmt::format("point {},", i), points[i]);
  }
  for (const glm::uvec3& t : triangles) {
    if (std::max({t.x, t.y, t.z}) >= points.size())
      throw bad_usage(fmt::format("a triangle ({}, {}, {}) uses a point that is not among the {} given", t.x, t.y, t.z,
                                  points.size()));
  }
  Places places;
  places.points = std::move(points);
  places.triangles = std::move(triangles);
  return places;
}

void add_place_options(CLI::App& app, PlaceOptions& options) {
  const line::Group group(app, "Where");
  group.choice("--plane", options.plane, plane_words,
               "computes on a plane; its two letters are the axes that point right and up");
  group.point("--centre", options.centre, "centre of the plane [0,0,0]");
  group.text("--size", options.size, "W,H", "width and height of the plane, such as 60mm,60mm", parse_size);
  group.text("--pixels", options.pixels, "N,M",
             "columns and rows of the plane; samples are at the pixels' centres [256 on the longer side]",
             [](const std::string& text) {
               Grid grid;
               set_pixels(text, grid);
             });
  group.pair("--line", options.line, "X,Y,Z", "computes on a line between two points, both included",
             [](const std::string& text) { parse_place("--line", text); });
  group.integer("--samples", options.samples, 2, 100'000'000,
                fmt::format("number of points on the line [{}]", default_samples));
  group.text("--points", options.points, "FILE",
             "computes at the points of a PLY file, or at the vertices of its surface");
  line::need(app, {"--centre", "--size", "--pixels"}, "--plane");
  line::need(app, {"--samples"}, "--line");
}

void check(const PlaceOptions& o) {
  const int kinds = int{o.plane.has_value()} + int{!o.line[0].empty()} + int{!o.points.empty()};
  if (kinds == 0)
    throw bad_usage("no place to look at: give --plane xy|xz|yz with --size, --line x,y,z x,y,z or --points FILE.ply");
  if (kinds > 1) throw bad_usage("--plane, --line and --points exclude each other: give one of them");
  if (o.plane) grid_of(o);
  if (!o.line[0].empty()) ends_of(o);
}

Places load_places(const PlaceOptions& options) {
  check(options);
  if (options.plane) return plane_places(grid_of(options));
  if (options.line[0].empty()) return file_of(options);
  const auto [from, to] = ends_of(options);
  return line_places(from, to, options.samples.value_or(default_samples));
}

}  // namespace palpa::setup
