// The sound that the application shows.

#include "base/error.hpp"
#include "session/links/spec.hpp"
#include "setup/assets.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/live_picture.hpp"

namespace palpa::viewer {

std::string finger_mesh(const std::string& skin, const std::string& source) {
  if (!skin.empty() || source.empty()) return skin;
  const session::Spec spec = session::parse_spec(source);
  if ((spec.name == "synthetic" || spec.name == "mouse") && !spec.argument.empty()) return spec.argument;
  try {
    return setup::find_asset("finger.ply");
  } catch (const Error&) {  // only the pressure needs it
    return {};
  }
}

Sounding App::sounding() {
  if (show_) return show_->sounding();
  const std::shared_ptr<const LiveScene>& scene = run_.scene();
  if (!scene || data_.live_state != LiveState::running) return {};
  const Snapshot& snapshot = run_.session()->snapshot();
  Sounding now = sounding_of(scene, snapshot);
  if (data_.state.layers.shows(Layer::slice))  // only the slice needs it
    now.slot = drive_of(*scene, snapshot.plan, data_.state.time.slot, live_.slot);
  if (now.tip && HeldFinger::is_held(run_.options().source)) now.T_world_finger = moved_.finger().pose();
  return now;
}

/// The plane begins in the middle of the first touch, unless the user has given it another place.
void App::place_slice_once() {
  if (slice_.placed || !data_.state.layers.shows(Layer::slice)) return;
  place_slice(data_.state, slice_.asked, picture());
  slice_.placed = !picture().fingers.empty() || !slice_.asked.at.empty();
}

void App::turn_slice(setup::Plane plane) {
  slice_.asked = {.plane = plane, .at = {}, .size_m = data_.state.slice.size_m.x};
  place_slice(data_.state, slice_.asked, picture());
  slice_.placed = !picture().fingers.empty();
}

void App::listen(double now_s) {
  place_slice_once();
  const Sounding now = sounding();
  data_.state.slice_handles = now.layout != nullptr;
  const Change change = sounds_.look(now, data_.state, data_.wants_spectrum, shown_picture(), now_s);
  stale_.add(change.skin ? Stale::skin : change.marks ? Stale::marks : Stale::nothing);
  data_.spectra = sounds_.spectra();
  for (const std::string& fault : sounds_.faults())
    say(log::Level::error, fault, now_s);
}

}  // namespace palpa::viewer
