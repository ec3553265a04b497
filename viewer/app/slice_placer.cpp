#include "viewer/app/slice_placer.hpp"

namespace palpa::viewer {

bool SlicePlacer::handle(const WindowEvent& event, const Sight& sight, ViewState& state) {
  const bool handles = state.slice_handles && state.layers.shows(Layer::slice);
  const bool taken = (handles || hand_.dragging()) && hand_.handle(event, sight, state.slice);
  placed_ = placed_ || taken;
  return taken;
}

void SlicePlacer::place_once(ViewState& state, const Picture& picture) {
  if (placed_ || !state.layers.shows(Layer::slice)) return;
  place_slice(state, asked_, picture);
  placed_ = !picture.fingers.empty() || !asked_.at.empty();
}

void SlicePlacer::turn(setup::Plane plane, ViewState& state, const Picture& picture) {
  asked_ = {.plane = plane, .at = {}, .size_m = state.slice.size_m.x};
  place_slice(state, asked_, picture);
  placed_ = !picture.fingers.empty();
}

}  // namespace palpa::viewer
