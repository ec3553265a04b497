// Positions and axes of all transducers of an array, in the array's own frame.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/math.hpp"

namespace palpa::array {

struct Transducer {
  Vec3 position;  ///< metres, layout frame
  Vec3 axis;      ///< unit vector, the direction it sounds in
};

struct Layout {
  std::string name;
  std::vector<Transducer> transducers;  ///< in drive order
  double source_level_pa_m = 4.386;     ///< peak pressure at 1 m on the axis at full amplitude, times 1 m
  /// Where it stands when neither rig nor user says: `paper` at the world's origin, a board 150 mm below it facing +y.
  Transform default_T_world_layout{1.0};
};

/// `autd3`, `paper`, `openmpd`, `openmpd-pair` or `sonicsurface`, or the path of a layout TOML. Throws bad_input naming file,
/// line and key; an unknown name lists the known ones.
Layout load_layout(const std::string& name_or_file);
std::vector<std::string> layout_names();

/// The same transducers in world coordinates.
Layout transformed(const Layout& layout, const Transform& T_world_layout);

}  // namespace palpa::array
