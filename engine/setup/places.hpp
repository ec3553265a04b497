// Where a field is looked at: a plane, a line, or the points of a file. Options, and the points that they stand for.
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

/// Its letters say which axes run to the right and up.
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
  std::vector<Vec3> points;           ///< metres; of a plane row by row from the top, of a line both ends included
  std::optional<Grid> grid;           ///< of a plane
  bool line = false;                  ///< each point is joined to the next
  std::vector<glm::uvec3> triangles;  ///< of a file that has faces: these are its vertices
};

/// The places of a plane, of a line between two points, and points as they are; all within 100 m of the origin. Throw
/// bad_usage for a plane without extent, for more than 65,536 pixels on a side, for fewer than two samples or a line
/// without length, for points that are farther away or no numbers, for none, and for triangles of points that are not
/// there; failure where so many points need more memory than is free.
Places plane_places(const Grid& grid);
Places line_places(const Vec3& from, const Vec3& to, std::uint32_t samples);
Places point_places(std::vector<Vec3> points, std::vector<glm::uvec3> triangles = {});

/// Throws bad_usage for options that say how a place is looked at where no place is given.
void refuse_without_place(const PlaceOptions& options);

/// Throws bad_usage for no place, several of them, a plane without extent, an option that goes with another kind of
/// place; bad_input for the file; failure where so many points need more than the memory that is free.
Places load_places(const PlaceOptions& options);

}  // namespace palpa::setup
