// Patterns that move in time, in the format of Adaptics: keyframes with a place, a brush and an intensity, formulas of
// parameters, and jumps. docs/sensations.md has the format and the rules.
//
// In this folder, as in the format: milliseconds, millimetres, degrees, hertz. x to the right, y away from the user, z
// away from the array, from the middle of its surface. played.hpp has SI units.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.hpp"

namespace palpa::sensation {

/// A number that parameters change: a constant, a parameter, or a formula.
struct Number {
  enum class Kind : std::uint8_t { constant, parameter, add, subtract, multiply, divide, negate };
  struct Node {
    Kind kind = Kind::constant;
    double value = 0;            ///< of a constant
    std::uint32_t a = 0, b = 0;  ///< operands, which stand before it; of a parameter, `a` is its number
  };
  std::vector<Node> nodes;  ///< the last one is the result; none: 0

  static Number of(double value) { return {{{Kind::constant, value, 0, 0}}}; }
  /// With the value of each parameter. IEEE arithmetic: a division by zero gives infinity or NaN.
  double at(std::span<const double> parameters) const;
};

/// How a track changes from a keyframe to the next one that sets it.
enum class Transition { linear, step };

struct Brush {
  enum class Kind { circle, line, lissajous };
  Kind kind = Kind::circle;
  Number size;      ///< the circle's radius, or half of the line's extent
  Number rotation;  ///< of a line in degrees, of a lissajous figure in radians
  Number am_hz, stm_hz;
  Number a, b, d, x_scale, y_scale;  ///< of a lissajous figure; d in radians
};

struct Intensity {
  bool random = false;  ///< between `low` and `high`, drawn in each evaluation; otherwise `low`
  Number low, high;
};

struct Jump {
  enum class Operator { lt, lt_eq, gt, gt_eq };
  std::uint32_t parameter = 0;
  Operator is = Operator::lt;
  double value = 0, to_ms = 0;
};

template <typename T>
struct Set {
  T value;
  Transition transition = Transition::linear;
};

struct Keyframe {
  enum class Kind { standard, pause, stop };
  Kind kind = Kind::standard;
  double time_ms = 0;
  std::optional<Set<Vec3>> coords;
  std::optional<Set<Brush>> brush;
  std::optional<Set<Intensity>> intensity;
  std::vector<Jump> jumps;  ///< the first whose condition holds is taken
};

struct Parameter {
  std::string name;
  bool defined = false;  ///< the pattern gives a default and limits
  double usual = 0;
  double low = 0, high = 0;  ///< no limit is an infinite one
};

/// What one keyframe search finds: the keyframe that set a track, and the time from which it counts. A pause gives the
/// coordinates that are held a new time, and a stop gives one to every track.
struct Found {
  std::int64_t keyframe = -1;  ///< -1: none
  double time_ms = 0;
};
struct FoundTracks {
  Found coords, brush, intensity;
};

struct Pattern {
  std::string file;  ///< for messages
  std::string name;
  std::vector<Keyframe> keyframes;  ///< by time
  std::vector<Parameter> parameters;
  struct {
    Number x, y, z;
  } translate, scale;
  Number rotation;  ///< degrees about z, counter-clockwise
  Number intensity_factor, playback_speed;
  /// For a time with i keyframes at or before it: what holds, and what comes.
  std::vector<FoundTracks> before, after;

  /// The parameter's number; nullopt if nothing in the pattern knows it.
  std::optional<std::uint32_t> parameter(std::string_view name) const;
};

/// The revisions that palpa reads, for people.
inline constexpr const char* known_revisions = "0.1.0-alpha.3, 0.1.0-alpha.2 and 0.0.10-alpha.1";
/// A file has at most so many bytes.
inline constexpr std::uint64_t most_pattern_bytes = std::uint64_t{16} << 20;

/// Throws bad_input, naming `file` and the part: no JSON, another format or revision, missing keys, numbers that are
/// not numbers, least values above greatest ones. Keys that the format does not know are ignored, with one warning.
Pattern parse_pattern(const std::string& text, const std::string& file);
/// The same of a file.
Pattern load_pattern(const std::string& file);

/// The value of each parameter of a pattern.
struct Values {
  std::vector<double> value;
  std::vector<bool> known;  ///< defined by the pattern, or given: conditions of others are false
};
/// Given values and defaults, both within the limits of the definitions. Names that the pattern does not know are left
/// out. Throws bad_usage for a value that is not finite.
Values values_of(const Pattern& pattern, const std::map<std::string, double>& given);

/// The highest frequency of a brush or of a modulation in any keyframe, with these values; 0 without.
double fastest_hz(const Pattern& pattern, const Values& values);

}  // namespace palpa::sensation
