// Which monitor --monitor names, and where two windows are on one.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "viewer/options/preferences.hpp"

namespace palpa::viewer {

/// The index of the monitor `wanted`: its number from 1, its name with or without its size, or "" for the last. `names`
/// are "NAME WxH". 0 without monitors. Throws bad_usage, which lists the monitors, for another name.
std::size_t chosen_monitor(const std::vector<std::string>& names, const std::string& wanted);

struct TwoPlaces {
  WindowPlace left, right;
  bool operator==(const TwoPlaces&) const = default;
};

/// Places for a panel and, to its right, a picture in the area of a monitor; nullopt if they lie there side by side
/// already. If there is not enough room, the picture gets smaller and keeps its shape, but at least half of the area's
/// width. If `sized`, it keeps its size, and the panel gets the rest, but at least a quarter of the width.
std::optional<TwoPlaces> side_by_side(const WindowPlace& area, const WindowPlace& panel, const WindowPlace& picture,
                                      bool sized);

}  // namespace palpa::viewer
