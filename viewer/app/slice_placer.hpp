// Where the plane of the field is: as the options ask, until the user drags or turns it.
#pragma once

#include "viewer/hands/slice_hand.hpp"
#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

class SlicePlacer {
 public:
  explicit SlicePlacer(AskedSlice asked) : asked_(std::move(asked)) {}

  /// Returns true if the event is meant for the plane's handles. What is held stays held until it is released, even
  /// while a run restarts and there are no handles.
  bool handle(const WindowEvent& event, const Sight& sight, ViewState& state);
  /// Puts the plane through the middle of the first touch, unless it was given another place. Does nothing while the
  /// layer is hidden.
  void place_once(ViewState& state, const Picture& picture);
  /// Turns it to these axes of the world, through the middle of the touch.
  void turn(setup::Plane plane, ViewState& state, const Picture& picture);

  bool placed() const { return placed_; }  ///< it was given a place
  /// The axes of the world in which it lies, before hands have turned it.
  const std::optional<setup::Plane>& plane() const { return asked_.plane; }

 private:
  AskedSlice asked_;
  SliceHand hand_;
  bool placed_ = false;
};

}  // namespace palpa::viewer
