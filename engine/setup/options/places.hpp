// The places at which a field is computed: a plane, a line, or the points of a file. Options, and the points that they
// mean.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "base/words.hpp"

namespace CLI {
class App;
}

namespace palpa::setup {

/// The letters are the axes that run to the right and up.
enum class Plane { xy, xz, yz };
inline constexpr Word<Plane> plane_words[] = {{"xy", Plane::xy}, {"xz", Plane::xz}, {"yz", Plane::yz}};

struct PlaceOptions {
  std::optional<Plane> plane;
  std::string centre, size, pixels;
  std::array<std::string, 2> line;
  std::optional<std::uint32_t> samples;
  std::string points;

  bool given() const { return plane || !line[0].empty() || !points.empty(); }
};
/// --plane --centre --size --pixels, --line --samples, --points.
void add_place_options(CLI::App& app, PlaceOptions& options);

/// Samples of a plane, at the centres of pixels.
struct Grid {
  Plane plane = Plane::xy;
  Vec3 centre{};                        ///< metres
  Vec2 size_m{};                        ///< right, up
  std::uint32_t columns = 0, rows = 0;  ///< both 0: square pixels, 256 on the longer side
};

struct Places {
  std::vector<Vec3> points;           ///< metres; for a plane, row by row from the top; for a line, including both ends
  std::optional<Grid> grid;           ///< only for a plane
  bool line = false;                  ///< each point is joined to the next
  std::vector<glm::uvec3> triangles;  ///< only for a file with faces: `points` are its vertices
};

/// The places of a plane, of a line between two points, and of given points; all within 100 m of the origin. Throw
/// bad_usage for a plane without extent, more than 65,536 pixels on a side, fewer than two samples, a line without
/// length, points that are farther away or not numbers, no points, and triangles with invalid point indices. Throw
/// failure if the points need more memory than is free.
Places plane_places(const Grid& grid);
Places line_places(const Vec3& from, const Vec3& to, std::uint32_t samples);
Places point_places(std::vector<Vec3> points, std::vector<glm::uvec3> triangles = {});

/// Throws bad_usage for no place, several places, a plane without extent, or a line without length. Reads no file.
void check(const PlaceOptions& options);

/// The places of these options. Throws as check does; bad_input for a faulty file; and failure if the points need more
/// memory than is free.
Places load_places(const PlaceOptions& options);

}  // namespace palpa::setup
