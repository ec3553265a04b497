// A plane moved by hand: it is dragged along its normal by its middle and turned about either of its axes by the ends
// of the other. Values and arithmetic: what is drawn and what is dragged stand on the same places.
#pragma once

#include <array>
#include <optional>

#include "base/math.hpp"
#include "viewer/hands/controls.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

enum class SliceHandle { middle, x_end, y_end };
inline constexpr std::array<SliceHandle, 3> slice_handles{SliceHandle::middle, SliceHandle::x_end, SliceHandle::y_end};
/// Where it is in the world.
Vec3 place_of(SliceHandle handle, const SliceState& slice);
/// Of the arrow along the normal that says which way the middle goes.
Vec3 normal_tip(const SliceState& slice);

class SliceHand {
 public:
  /// True where the event is the hand's alone. Handles are what is within some points of the pointer. Escape lets go of
  /// what is dragged, where it was.
  bool handle(const WindowEvent& event, const Sight& sight, SliceState& slice);
  bool dragging() const { return held_.has_value(); }

 private:
  std::optional<SliceHandle> held_;
  SliceState before_;  ///< when it was taken
  double x_ = 0, y_ = 0;
};

}  // namespace palpa::viewer
