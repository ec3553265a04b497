// The live run in a window: how it begins, changes and ends, and what is shown of it.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "setup/interrupt.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/live/live_picture.hpp"
#include "viewer/options/touch_edit.hpp"

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

constexpr double room_for_finger = 0.03;  ///< above an object

/// What errors are about.
constexpr const char *about_options = "options", *about_run = "run";

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
  if (HeldFinger::is_held(run_.options().source) && !std::exchange(told_of_finger_, true))
    say(log::Level::info,
        "The pointer holds a fingertip: move it down onto the object. M lets go of it, and H shows all keys.", now_s_);
  moved_.begin_run(*run_.session(), run_.options().scene);
  data_.live_state = LiveState::loading;
}

/// Gives the run these options. `again`: another run begins even if they are the same. If they do not go together,
/// everything stays as it is.
void App::change_run(LiveEdit edit, bool again) {
  const bool other = data_.live && (again || !edit.runs_as(data_.edit));
  if (other && !goes_together(edit)) return;
  settled(about_options);
  data_.edit = std::move(edit);
  if (other) run_.change(data_.edit.options());
  run_.set_ceiling(data_.edit.options().safety.ceiling);
}

/// If not, shows the reason.
bool App::goes_together(const LiveEdit& edit) {
  try {
    edit.check();
    return true;
  } catch (const Error& error) {
    say(log::Level::error, error.what(), now_s_, about_options);
    return false;
  }
}

/// Begins again, whether switched off or not. A touch becomes a live run with a finger that the pointer holds, unless
/// another source is given.
void App::start_run() {
  LiveEdit edit = data_.edit;
  if (data_.live) {
    if (goes_together(edit)) run_.start(edit.options());
    return;
  }
  if (!edit.line().contains("--source")) edit.set("--source", "mouse");
  go_live(std::move(edit));
}

/// The single touch ends, and a live run begins. Options that only concern the touch are ignored from then on.
void App::go_live(LiveEdit edit) {
  edit.leave_touch();
  if (!around_.goes_live || !goes_together(edit)) return;
  around_.goes_live();
  data_.live = true;
  data_.edit = std::move(edit);
  live_.picture = show_->picture();
  live_.framed = show_->picture().solids.empty() ? "" : data_.edit.options().scene;
  show_.reset();
  sounds_.forget();
  data_.state.time.playing = true;
  run_.start(data_.edit.options());
  begin_run();
}

/// Sets an option to the text of its field. If that is not a value of the option, everything stays as it is.
void App::set_option(const OptionText& asked, double now_s) {
  LiveEdit edit = data_.edit;
  try {
    edit.set(asked.option, asked.text);
    if (!data_.live) set_touch_option(edit, asked);
  } catch (const Error& error) {
    return say(log::Level::error, error.what(), now_s, about_options);
  }
  change_run(std::move(edit));
}

/// A touch has most of the options of a run, and is found again with them. Throws bad_usage.
void App::set_touch_option(const LiveEdit& edit, const OptionText& asked) {
  const auto info = std::ranges::find(live_table(), asked.option, &setup::OptionInfo::name);
  const bool applies = info != live_table().end() && is_of_touch(*info);
  if (!applies || data_.empty || edit.options().scene.empty()) return;
  TouchEdit touch(options_);
  touch.set(asked.option, asked.text);
  touch.check();
  stale_.redraw();
  opening_.begin_touch(touch.options(), touch.options().input.scene == options_.input.scene);
}

/// The first object is seen as the command line says, another one from the same side. If the pointer holds the finger,
/// objects are seen from near, because the pointer has to hit them.
void App::frame_object(const Size& size) {
  const std::string& scene = run_.options().scene;
  const bool first = live_.framed.empty(), other = live_.framed != scene;
  const auto given = [&](const char* option) { return options_.given.contains(option); };
  const bool as_given = first && (given("--view") || given("--eye") || given("--frame"));
  live_.framed = scene;
  if (first) data_.state.viewpoint = first_viewpoint(options_, picture(), data_.state, size);
  if (!other || as_given) return;
  if (!HeldFinger::is_held(run_.options().source)) {
    data_.asked.frame = !first;
    return;
  }
  Box box = extent(picture(), Extent::objects, data_.state);
  box.add(Vec3(box.centre().x, box.high.y + room_for_finger, box.centre().z));
  fit(data_.state.viewpoint, box, static_cast<double>(std::max(size.width, 1u)) / std::max(size.height, 1u));
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
    frame_object(size);
  }
  live_.fresh = live_.fresh || fresh;
  live_.any = live_.any || fresh;
  if (run_.scene() && (fresh || seen)) {
    show_live(live_.picture, *run_.scene(), session.snapshot(), session.seen(), data_.state.layers.shows(Layer::depth));
    data_.numbers = session.snapshot().numbers;
    show_slot_now();
  }
  if (const std::optional<std::string> fault = run_.advance()) {
    stale_.redraw();
    if (!fault->empty()) say(log::Level::error, *fault, now_s, about_run);
  }
  if (run_.state() == RunState::running) settled(about_run);
  if (run_.state() != RunState::ready) return;
  if (quitting_) return run_.stay();
  show_recording(now_s);  // a recording ends with its run
  begin_run();
}

/// Shows what the session does, and what leaves for the array.
void App::show_link(double now_s) {
  const LiveSession& session = *run_.session();
  const LinkWatch& link = session.link();
  const bool sounding = link.sound.sounding(), stuck = link.sound.stuck();
  const LiveState state = session.state();
  if (data_.sounding != sounding || data_.stuck != stuck || data_.live_state != state) stale_.redraw();
  data_.sounding = sounding;
  data_.stuck = stuck;
  data_.drives = link.drives;
  data_.silent_drives = link.silent;
  data_.live_state = state;
  data_.fault = state == LiveState::failed ? session.fault() : std::string();
  data_.playback = player_.now();
  show_recording(now_s);
}

/// Shows what is being recorded, and how many frames an ended recording has.
void App::show_recording(double now_s) {
  const LiveSession& session = *run_.session();
  std::string folder = session.recording();
  if (folder != data_.recording && !data_.recording.empty()) {
    const std::uint64_t frames = session.recorded();
    say(log::Level::info, fmt::format("{}: {}", data_.recording, counted(frames, "frame")), now_s);
    if (frames > 0) remember_file(data_.made = data_.recording);
  }
  data_.recording = std::move(folder);
  data_.recorded = session.recorded();
}

/// Begins or ends a recording of the frames.
void App::record(double now_s) {
  if (!run_.session() || data_.live_state != LiveState::running) return;
  if (!run_.session()->recording().empty()) return run_.session()->record({});
  const std::string folder = free_folder();
  run_.session()->record(folder);
  say(log::Level::info, folder + ": recording what the cameras see", now_s);
}

}  // namespace palpa::viewer
