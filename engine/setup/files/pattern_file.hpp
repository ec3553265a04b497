// Patterns of sound in space: control points with wanted amplitudes, as TOML. Their sound does not follow a hand.
//
//   name = "four corners, silent between them"   # default: the file's name
//
//   [[point]]
//   position_m = [0.01, 0, 0.15]                  # in the layout's own frame
//   amplitude = 1                                 # relative to the loudest point, from 1e-4 on; 0: silent
//   radius_m = 0.0005                             # only of a silent point: a ball, at most 5 mm
//
//   [[curve]]                                     # points at equal distances along straight lines
//   corners_m = [0, 0, 0.15, 0.02, 0, 0.15]       # x, y, z of each corner
//   points = 8
//   closed = false                                # whether the last corner is joined to the first
//   amplitude = 0.5
//
//   [[plane]]                                     # a grid of points, rows from the top
//   centre_m = [0, 0, 0.15]
//   right_m = [0.005, 0, 0]                       # from a column to the next,
//   up_m = [0, 0.005, 0]                          # and from a row to the one above it
//   rows = ["#.#", ".0.", "#.#"]                  # # 1, 1 to 9 tenths, 0 silent, . no point
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "array/nulls/nulls.hpp"
#include "base/math.hpp"

namespace palpa::setup {

/// The most points that sound, and that are silent.
inline constexpr std::size_t most_pattern_points = 64, most_pattern_nulls = array::most_nulls;

struct Pattern {
  struct Point {
    Vec3 position;
    float amplitude;  ///< above 0, at most 1; the loudest point has 1
  };
  std::string name;
  std::vector<Point> points;       ///< at least one, in the file's order: points, curves, planes
  std::vector<array::Null> nulls;  ///< the silent ones
};

/// Throws bad_input, naming file and line, for a text that is no pattern: unknown keys, numbers out of range, too many
/// points, two at one place, none that sounds. Places are within 100 m of the origin.
Pattern parse_pattern(std::string_view text, const std::string& file);
/// The pattern of that name, or in that file. Throws bad_input also for a name that is neither; the error lists those
/// that are known.
Pattern load_pattern(const std::string& name_or_file);
/// Palpa's own patterns as text for people: "carter, gavrilov, ..." (assets/patterns, docs/patterns.md).
std::string known_patterns();
/// Their names.
std::vector<std::string> pattern_names();

}  // namespace palpa::setup
