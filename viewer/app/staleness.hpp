// Which part of a picture is out of date.
#pragma once

#include <cstdint>

#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// How much of the picture on the device must be updated. Each value includes those before it, see DrawnPicture.
enum class Stale { nothing, marks, skin, surfaces };

/// Begins with a new picture. Nothing of it has been drawn yet.
class Staleness {
 public:
  /// Call when this much of the picture has changed.
  void add(Stale what);
  /// Call when something over the picture, or the viewpoint, has changed.
  void redraw() { dirty_ = true; }
  /// Compares `now` with the picture on the device: it may need other marks, or surfaces in other places.
  void look(const ViewState& now);

  Stale what() const { return what_; }
  /// Returns what must be updated. The caller then updates it to `now`.
  Stale take(const ViewState& now);
  /// Whether a new drawing would look different. Call drew() after each drawing.
  bool dirty() const { return dirty_; }
  void drew() { dirty_ = false; }
  /// Changes whenever surfaces change or move.
  std::uint64_t surfaces_version() const { return surfaces_version_; }

 private:
  Stale what_ = Stale::surfaces;
  bool dirty_ = true;
  std::uint64_t surfaces_version_ = 1;
  ViewState drawn_;  ///< the state from which the picture on the device was made
};

}  // namespace palpa::viewer
