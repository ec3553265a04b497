// What of a picture is not up to date.
#pragma once

#include <cstdint>

#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// How much of what is on the device is to be brought up to date; each has what stands before it, see DrawnPicture.
enum class Stale { nothing, marks, skin, surfaces };

/// Of a picture that is new: nothing was drawn yet.
class Staleness {
 public:
  /// As much of the picture has changed.
  void add(Stale what);
  /// What lies over the picture has changed, or from where it is looked at.
  void redraw() { dirty_ = true; }
  /// Whether `now` asks for other marks, or for surfaces elsewhere, than the picture on the device has.
  void look(const ViewState& now);

  Stale what() const { return what_; }
  /// What is to be brought up to date, which is then as `now` asks for.
  Stale take(const ViewState& now);
  /// Whether another drawing would look different; drew() says that there was one.
  bool dirty() const { return dirty_; }
  void drew() { dirty_ = false; }
  /// Another number where surfaces are others, or elsewhere.
  std::uint64_t surfaces_version() const { return surfaces_version_; }

 private:
  Stale what_ = Stale::surfaces;
  bool dirty_ = true;
  std::uint64_t surfaces_version_ = 1;
  ViewState drawn_;  ///< as the picture on the device was made
};

}  // namespace palpa::viewer
