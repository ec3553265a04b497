// The live run in a window: how it begins, changes and ends, and what is shown of it.
#include <fmt/core.h>

#include <filesystem>
#include <utility>

#include "base/error.hpp"
#include "setup/interrupt.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/live_picture.hpp"

namespace palpa::viewer {
namespace {

/// The first folder of "recording-1", "recording-2", ... that does not exist.
std::string free_folder() {
  for (int i = 1;; ++i) {
    std::string name = fmt::format("recording-{}", i);
    std::error_code ignored;
    if (!std::filesystem::exists(name, ignored)) return name;
  }
}

}  // namespace

/// Begins the run that is ready. Each run warns about unusual options.
void App::begin_run() {
  setup::check(run_.next());
  sounds_.set_finger(finger_mesh(options_.skin, run_.next().source));
  const auto lines = run_.begin();
  live_.any = false;
  if (!lines) return void(quitting_ = true);
  for (const std::string& line : *lines)
    say(log::Level::info, line, now_s_);
  moved_.begin_run(*run_.session(), run_.options().scene);
  desk_.live_state = LiveState::loading;
}

/// Gives the run these options. `again`: another run begins even if they are the same. If they do not go together,
/// everything stays as it is.
void App::change_run(LiveEdit edit, bool again) {
  const bool other = desk_.live && (again || !edit.runs_as(desk_.edit));
  if (other && !goes_together(edit)) return;
  desk_.edit = std::move(edit);
  if (other) run_.change(desk_.edit.options());
}

/// If not, shows the reason.
bool App::goes_together(const LiveEdit& edit) {
  try {
    edit.check();
    return true;
  } catch (const Error& error) {
    say(log::Level::error, error.what(), now_s_);
    return false;
  }
}

/// Begins again, whether switched off or not.
void App::start_run() {
  if (goes_together(desk_.edit)) run_.start(desk_.edit.options());
}

/// Sets an option to the text of its field. If that is not a value of the option, everything stays as it is.
void App::set_option(const OptionText& asked, double now_s) {
  LiveEdit edit = desk_.edit;
  try {
    edit.set(asked.option, asked.text);
  } catch (const Error& error) {
    return say(log::Level::error, error.what(), now_s);
  }
  change_run(std::move(edit));
}

void App::advance_live(double now_s, const Size& size) {
  if (setup::Interrupt::signalled()) quitting_ = true;
  LiveSession& session = *run_.session();
  session.look();
  show_link(now_s);

  // Before asking for the scene, so that a snapshot's scene is there.
  const bool fresh = session.take();
  const bool seen = session.take_seen();
  if (run_.take_scene()) {
    const Picture& rest = run_.scene()->picture;
    live_.picture = rest;
    sounds_.forget();
    stale_.add(Stale::surfaces);
    moved_.begin_scene(session, rest, run_.options().scene, HeldFinger::is_held(run_.options().source));
    place();
    if (!std::exchange(live_.framed, true))
      desk_.state.viewpoint = first_viewpoint(options_, picture(), desk_.state, size);
  }
  live_.fresh = live_.fresh || fresh;
  live_.any = live_.any || fresh;
  if (run_.scene() && (fresh || seen)) {
    show_live(live_.picture, *run_.scene(), session.snapshot(), session.seen(), desk_.state.layers.shows(Layer::depth));
    desk_.numbers = session.snapshot().numbers;
    show_slot_now();
  }
  if (const std::optional<std::string> fault = run_.advance()) {
    stale_.redraw();
    if (!fault->empty()) say(log::Level::error, *fault, now_s);
  }
  if (run_.state() != RunState::ready) return;
  if (quitting_) return run_.stay();
  show_recording(now_s);  // a recording ends with its run
  begin_run();
}

/// Shows what the session does, and what leaves for the array.
void App::show_link(double now_s) {
  const LiveSession& session = *run_.session();
  const LinkWatch& link = session.link();
  const bool sounding = link.sounding;
  const LiveState state = session.state();
  if (desk_.sounding != sounding || desk_.live_state != state) stale_.redraw();
  desk_.sounding = sounding;
  desk_.link_open = link.open;
  desk_.drives = link.drives;
  desk_.silent_drives = link.silent;
  desk_.live_state = state;
  desk_.playback = player_.now();
  show_recording(now_s);
}

/// Shows what is being recorded, and how many frames an ended recording has.
void App::show_recording(double now_s) {
  const LiveSession& session = *run_.session();
  std::string folder = session.recording();
  if (folder != desk_.recording && !desk_.recording.empty())
    say(log::Level::info, fmt::format("{}: {} frames", desk_.recording, session.recorded()), now_s);
  desk_.recording = std::move(folder);
  desk_.recorded = session.recorded();
}

/// Begins or ends a recording of the frames.
void App::record(double now_s) {
  if (!run_.session() || desk_.live_state != LiveState::running) return;
  if (!run_.session()->recording().empty()) return run_.session()->record({});
  const std::string folder = free_folder();
  run_.session()->record(folder);
  say(log::Level::info, folder + ": recording what the cameras see", now_s);
}

}  // namespace palpa::viewer
