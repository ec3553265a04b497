// What the application shows of sound.

#include "base/error.hpp"
#include "session/spec.hpp"
#include "setup/assets.hpp"
#include "viewer/app.hpp"

namespace palpa::viewer {

/// Of --skin; of a made-up finger the mesh that it is made of.
std::string finger_mesh(const ViewerOptions& options) {
  if (!options.skin.empty() || !options.is_live()) return options.skin;
  const session::Spec source = session::parse_spec(options.given.at("--source").front());
  if ((source.name == "synthetic" || source.name == "mouse") && !source.argument.empty()) return source.argument;
  try {
    return setup::find_asset("finger.ply");
  } catch (const Error&) {  // nothing but the pressure needs it
    return {};
  }
}

Sounding App::sounding() const {
  if (show_) return show_->sounding();
  Sounding now;
  if (!live_ || !scene_ || desk_.live_state != LiveState::running) return now;
  const session::Plan& plan = live_->snapshot().plan;
  now.layout = std::shared_ptr<const array::Layout>(scene_, &scene_->layout);
  now.drive = scene_->drive;
  now.air = scene_->air;
  now.spot_m = scene_->spot_m;
  const std::size_t transducers = scene_->layout.transducers.size();
  if (plan.schedule.voice_count == 0 || plan.cycle == 0 || plan.drives.size() != plan.cycle * transducers) return now;
  now.schedule = &plan.schedule;
  now.plan = &plan;
  now.slot = plan.drive(desk_.state.time.slot, transducers);
  now.tip = tip_of(live_->snapshot().touch);
  if (now.tip && holds_finger()) now.T_world_finger = finger_.pose();
  return now;
}

/// The plane begins in the middle of the first touch, unless somebody has said or dragged it elsewhere.
void App::place_slice_once() {
  if (slice_placed_ || !desk_.state.layers.shows(Layer::slice)) return;
  place_slice(desk_.state, options_, picture());
  slice_placed_ = !picture().fingers.empty() || !options_.slice_at.empty();
}

void App::turn_slice(setup::Plane plane) {
  options_.slice_plane = plane;
  options_.slice_at.clear();
  options_.slice_size_m = desk_.state.slice.size_m.x;
  place_slice(desk_.state, options_, picture());
  slice_placed_ = !picture().fingers.empty();
}

void App::listen(double now_s) {
  place_slice_once();
  const Sounding now = sounding();
  desk_.state.slice_handles = now.layout != nullptr;
  const Change change = sounds_.look(now, desk_.state, desk_.wants_spectrum, shown_picture(), now_s);
  stale_surfaces_ = stale_surfaces_ || change.surfaces;
  stale_marks_ = stale_marks_ || change.marks;
  dirty_ = dirty_ || change.surfaces || change.marks;
  desk_.spectra = sounds_.spectra();
  if (const std::string fault = sounds_.fault(); !fault.empty()) say(log::Level::error, fault, now_s);
}

}  // namespace palpa::viewer
