// Positions and axes of all transducers of an array, in the array's own frame. docs/layouts.md draws the built-in ones.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "array/amplitudes.hpp"
#include "base/math.hpp"

namespace palpa::array {

struct Transducer {
  Vec3 position;  ///< metres, layout frame
  Vec3 axis;      ///< unit vector, the direction of its sound
};

/// One physical board of a layout: a rectangle centred on the board's origin in its z = 0 plane, sounding towards +z.
struct Board {
  std::string type;         ///< its record is find_board_type(type), board_types.hpp
  std::uint32_t first = 0;  ///< index of its first transducer
  std::uint32_t count = 0;  ///< its transducers are first .. first + count - 1, in the board type's own order
  double width_m = 0;       ///< along the board's x
  double height_m = 0;      ///< along the board's y
  Transform T_layout_board{1.0};
};

/// The maximum number of transducers in a layout: sixteen times the paper's, and fewer than the iterations after which
/// a software device ends a kernel's loops.
inline constexpr std::uint32_t max_transducers = 65000;

struct Layout {
  std::string name;
  std::vector<Transducer> transducers;  ///< in drive order
  std::vector<Board> boards;            ///< ascending by `first`; individual transducers belong to no board
  /// 0..1: what the amplitude of each transducer is multiplied by, from its board's own file. Empty: nothing. Only
  /// links to boards fill it (session::Link::boards).
  std::vector<float> factors{};
  double source_level_pa_m = 4.386;  ///< peak pressure at 1 m on the axis at full amplitude, times 1 m
  double frequency_hz = 40e3;        ///< the design frequency of its transducers
  /// The amplitudes of a focus that sounds alone, unless the user says otherwise. `paper`: by distance, as in the
  /// paper.
  Weighting amplitude_law = Weighting::uniform;
  double transducer_radius_m = 4.5e-3;  ///< of the sounding part; the piston's directivity depends on it
  /// The default pose if neither rig nor user gives one: `paper` at the world's origin, a board 150 mm below it facing
  /// +y.
  Transform default_T_world_layout{1.0};
};

/// One of layout_names(), or the path of a layout TOML (schema in docs/layouts.md). Throws bad_input naming file, line
/// and key. The error for an unknown name lists the known ones.
Layout load_layout(const std::string& name_or_file);
std::vector<std::string> layout_names();
/// The same as text for people: "autd3, paper, ...".
std::string known_layouts();
/// The layout with axes of exactly length 1, for transducers that come from no file. Throws bad_usage naming what is
/// wrong: no transducer or too many, one too far out, an axis that is no unit vector, two at the same place, a value
/// out of range.
Layout checked(Layout layout);
/// During its lifetime, load_layout() knows a layout that has no file, by a name of its own.
class KnownLayout {
 public:
  explicit KnownLayout(Layout layout);
  ~KnownLayout();
  KnownLayout(const KnownLayout&) = delete;
  KnownLayout& operator=(const KnownLayout&) = delete;
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};
/// Farther out, an array's phases are meaningless, and floats are too imprecise for them.
inline constexpr double most_layout_m = 10;
inline constexpr double most_source_level_pa_m = 1e4, most_transducer_radius_m = 0.1;
/// How far an axis may be from length 1. For values typed by people: 0.7071 for the root of a half.
inline constexpr double axis_tolerance = 1e-3;
/// The first two transducers at the same place, by position and index.
std::optional<std::pair<std::uint32_t, std::uint32_t>> coinciding(const std::vector<Transducer>& transducers);

/// Whether this is the name of a built-in layout or of an existing file.
bool is_layout(const std::string& name_or_file);

/// The same transducers and boards in world coordinates. `T_world_layout` is rigid.
Layout transformed(const Layout& layout, const Transform& T_world_layout);

}  // namespace palpa::array
