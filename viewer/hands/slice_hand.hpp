// A plane that is moved by hand. Its middle drags it along its normal, and the ends of one axis turn it about the
// other. Values and arithmetic only: handles are drawn and dragged at the same places.
#pragma once

#include <array>
#include <optional>

#include "base/math.hpp"
#include "viewer/hands/controls.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

enum class SliceHandle { middle, x_end, y_end };
inline constexpr std::array<SliceHandle, 3> slice_handles{SliceHandle::middle, SliceHandle::x_end, SliceHandle::y_end};
/// Where the handle is in the world.
Vec3 place_of(SliceHandle handle, const SliceState& slice);
/// The tip of the arrow along the normal, which shows the way in which the middle moves.
Vec3 normal_tip(const SliceState& slice);

class SliceHand {
 public:
  /// Returns true if the event is only for this hand. It takes a handle within some points of the pointer. Escape
  /// returns what is dragged to its old place.
  bool handle(const WindowEvent& event, const Sight& sight, SliceState& slice);
  bool dragging() const { return held_.has_value(); }

 private:
  std::optional<SliceHandle> held_;
  SliceState before_;  ///< when the handle was taken
  double x_ = 0, y_ = 0;
};

}  // namespace palpa::viewer
