// Where two windows are on one monitor, so that neither covers the other.
#pragma once

#include <optional>

#include "viewer/options/settings.hpp"

namespace palpa::viewer {

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
