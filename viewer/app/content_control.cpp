#include "viewer/app/content_control.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "geometry/gltf/write.hpp"
#include "session/links/spec.hpp"
#include "setup/files/assets.hpp"
#include "viewer/app/own_files.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/live/live_picture.hpp"
#include "viewer/options/touch_edit.hpp"

namespace palpa::viewer {
namespace {

namespace fs = std::filesystem;

/// What errors are about.
constexpr const char *about_options = "options", *about_opening = "opening";
constexpr std::size_t most_recent = 6;

}  // namespace

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

ContentControl::ContentControl(const ViewerOptions& options, LiveSession::Kinds kinds, std::atomic<bool>& stop,
                               const std::function<void()>& wake, std::function<void()> goes_live, Content& content,
                               Messages& messages, Staleness& stale)
    : options_(options),
      goes_live_(std::move(goes_live)),
      content_(&content),
      messages_(&messages),
      stale_(&stale),
      run_(std::move(kinds), stop, wake, content.run, messages, stale),
      opening_(wake),
      sounds_(setup::device_options(options.common)) {
  content.edit = LiveEdit(options_.given);
  content.live = options_.is_live();
}

void ContentControl::begin() {
  if (content_->live) {
    run_.control().start(content_->edit.options());
    begin_run();
  } else {
    if (!shows_example()) touch_ = std::make_unique<ShownTouch>(options_);
    sounds_.set_finger(finger_mesh(options_.skin, {}));
  }
}

/// If there is nothing to show, shows a finger on the cube, until the user chooses something. Without palpa's own
/// files, the window stays empty.
bool ContentControl::shows_example() {
  const setup::TouchInputOptions& input = options_.input;
  const bool empty = input.scene.empty() && input.rig.empty() && options_.layout.empty() && options_.skin.empty() &&
                     options_.sensation.empty();
  if (!empty || !goes_live_) return false;
  try {
    ViewerOptions example;
    example.common.backend = setup::Backend::cpu;
    example.common.quiet = true;
    example.input.scene = setup::find_asset("cube.glb");
    example.input.points = example.skin = setup::find_asset("finger.ply");
    example.input.penetration_m = 3e-3;
    touch_ = std::make_unique<ShownTouch>(example);
    example_ = content_->empty = true;
  } catch (const Error&) {
    example_ = false;
  }
  return example_;
}

void ContentControl::show_slot(std::uint64_t slot) {
  if (!touch_) return run_.show_slot(slot);
  touch_->go_to(slot);
  stale_->add(Stale::marks);
}

Sounding ContentControl::sounding(std::optional<std::uint64_t> slot) {
  return touch_ ? touch_->sounding() : run_.sounding(slot);
}

std::string ContentControl::title() const {
  const std::string name = fs::path(content_->edit.options().scene).filename().string();
  if (options_.guided) return "cameras by touch";
  if (content_->live) return fmt::format("{}, live ({})", name, content_->edit.options().source);
  if (content_->empty) return "";
  if (!options_.sensation.empty() && name.empty()) return options_.sensation;
  if (name.empty()) return options_.layout.empty() ? options_.input.rig : options_.layout;
  return name + (picture().fingers.empty() ? "" : ", one touch");
}

// ---- the run and its options --------------------------------------------------------------------------------------

void ContentControl::begin_run() {
  sounds_.set_finger(finger_mesh(options_.skin, run_.control().next().source));
  ended_ = !run_.begin();
}

bool ContentControl::look_at_run() {
  const bool scene = run_.look();
  if (scene) sounds_.forget();
  if (const std::string made = run_.take_made(); !made.empty()) remember(content_->made = made);
  return scene;
}

void ContentControl::follow_run(bool quitting) {
  if (!run_.follow()) return;
  quitting ? run_.control().stay() : begin_run();
}

/// Gives the run these options. `again`: another run begins even if they are the same. If they do not go together,
/// everything stays as it is.
void ContentControl::change_run(LiveEdit edit, bool again) {
  const bool other = content_->live && (again || !edit.runs_as(content_->edit));
  if (other && !goes_together(edit)) return;
  messages_->settled(about_options);
  content_->edit = std::move(edit);
  if (other) run_.control().change(content_->edit.options());
  run_.control().set_ceiling(content_->edit.options().safety.ceiling);
}

/// If not, shows the reason.
bool ContentControl::goes_together(const LiveEdit& edit) {
  try {
    edit.check();
    return true;
  } catch (const Error& error) {
    messages_->say(log::Level::error, error.what(), about_options);
    return false;
  }
}

void ContentControl::start() {
  LiveEdit edit = content_->edit;
  if (content_->live) {
    if (goes_together(edit)) run_.control().start(edit.options());
    return;
  }
  if (!edit.line().contains("--source")) edit.set("--source", "mouse");
  go_live(std::move(edit));
}

/// The single touch ends, and a live run begins. Options that only concern the touch are ignored from then on.
void ContentControl::go_live(LiveEdit edit) {
  edit.leave_touch();
  if (!goes_live_ || !goes_together(edit)) return;
  goes_live_();
  content_->live = true;
  content_->edit = std::move(edit);
  if (!std::exchange(example_, false)) run_.picture() = touch_->picture();
  touch_.reset();
  sounds_.forget();
  run_.control().start(content_->edit.options());
  begin_run();
}

void ContentControl::set_option(const OptionText& asked) {
  LiveEdit edit = content_->edit;
  try {
    edit.set(asked.option, asked.text);
    if (!content_->live) find_touch_again(asked, edit);
  } catch (const Error& error) {
    return messages_->say(log::Level::error, error.what(), about_options);
  }
  change_run(std::move(edit));
}

/// A touch has most of the options of a run, and is found again with them. Throws bad_usage.
void ContentControl::find_touch_again(const OptionText& asked, const LiveEdit& edit) {
  const auto info = std::ranges::find(live_table(), asked.option, &line::OptionInfo::name);
  const bool applies = info != live_table().end() && is_of_touch(*info);
  if (!applies || content_->empty || edit.options().scene.empty()) return;
  TouchEdit touch(options_);
  touch.set(asked.option, asked.text);
  touch.check();
  stale_->redraw();
  opening_.begin_touch(touch.options(), touch.options().input.scene == options_.input.scene);
}

void ContentControl::save_scene(const std::string& file) {
  const std::shared_ptr<const LiveScene>& scene = run_.control().scene();
  if (!scene) return;
  try {
    const Outputs outputs({{"save as", file}});
    geometry::write_glb(file, meshes_of(*scene, run_.placing().poses()));
  } catch (const Error& error) {
    return messages_->say(log::Level::error, error.what());
  }
  messages_->say(log::Level::info, file + ": is now the scene");
  remember(file);
  run_.forget_places();
  LiveEdit edit = content_->edit;
  edit.replace_scene(file);
  change_run(std::move(edit), true);
}

// ---- what is opened -----------------------------------------------------------------------------------------------

void ContentControl::open(const std::string& path) {
  const fs::path file(path);
  const std::string ending = file.extension().string();
  std::error_code ignored;
  if (ending == ".glb" || ending == ".gltf") return open_scene(path);
  if (ending == ".ply") return open_points(path);
  if (!fs::is_directory(file, ignored) && file.filename() != "recording.toml")
    return messages_->say(log::Level::warning, path + ": is not a .glb, a .gltf, a .ply or a recording", about_opening);
  if (!content_->live && !goes_live_)
    return messages_->say(log::Level::warning, "a recording needs --source: start palpa-viewer with it");
  stale_->redraw();
  opening_.begin_recording(path);
}

/// The run or the picture stays until the file is loaded and found to be a scene. In an empty window, a live run of it
/// begins.
void ContentControl::open_scene(const std::string& path) {
  stale_->redraw();
  LiveEdit edit = content_->edit;
  edit.open_scene(path);
  const bool same = edit.runs_as(content_->edit);
  if (content_->live || (content_->empty && goes_live_)) {
    if (goes_together(edit)) opening_.begin_scene(edit.options(), same);
    return;
  }
  TouchEdit touch(options_);
  touch.open_scene(path);
  opening_.begin_touch(touch.options(), same);
}

/// A PLY is what touches: the finger that the pointer holds, or the skin of a single touch.
void ContentControl::open_points(const std::string& path) {
  if (content_->live || content_->empty) {
    set_option({"--source", "mouse:" + path});
    if (content_->empty) messages_->say(log::Level::info, path + ": touches the object that you open next");
    return;
  }
  try {
    TouchEdit touch(options_);
    touch.use_points(path);
    touch.check();
    stale_->redraw();
    opening_.begin_touch(touch.options(), true);
  } catch (const Error& error) {
    messages_->say(log::Level::error, error.what(), about_opening);
  }
}

void ContentControl::open_neighbour(int by) {
  const std::string& now = content_->edit.options().scene;
  if (now.empty()) return;
  const std::vector<std::string> scenes = scenes_beside(now);
  const auto here = std::ranges::find(scenes, fs::path(now).filename(),
                                      [](const std::string& scene) { return fs::path(scene).filename(); });
  if (here == scenes.end() || scenes.size() < 2)
    return messages_->say(log::Level::warning, now + ": its folder has no other object to switch to");
  const auto count = static_cast<std::ptrdiff_t>(scenes.size());
  const std::ptrdiff_t next = (here - scenes.begin() + by + count) % count;
  open(scenes[static_cast<std::size_t>(next)]);
}

/// A run that has ended stays silent until a person starts it. A run that failed before it had a scene has never
/// sounded, and the new file is probably the repair, so this run begins again.
void ContentControl::watch_scene(double now_s) {
  const std::string scene = content_->edit.options().scene;
  if (!watch_.look(scene, now_s)) return;
  const RunControl& run = run_.control();
  const bool over = run.state() == RunState::ended || (run.state() == RunState::failed && run.scene());
  if (!content_->live || !over) return open(scene);
  messages_->say(log::Level::info, scene + ": was written again; Start begins a run with it");
}

bool ContentControl::take_opened() {
  content_->opening = opening_.busy();
  std::optional<Opened> opened = opening_.take();
  if (!opened) return false;
  stale_->redraw();
  if (!opened->fault.empty()) {
    messages_->say(log::Level::error, opened->fault, about_opening);
    return false;
  }
  messages_->settled(about_opening);
  remember(opened->path);
  if (opened->kind == Opened::Kind::recording) {
    play_recording(opened->path);
    return false;
  }
  LiveEdit edit = content_->edit;
  edit.open_scene(opened->path);
  if (opened->kind == Opened::Kind::scene && !content_->live) {
    content_->edit = std::move(edit);
    start();
    return false;
  }
  change_run(std::move(edit), opened->same);
  if (opened->kind != Opened::Kind::touch) return false;
  touch_ = std::move(opened->touch);
  example_ = false;
  options_ = std::move(*opened->options);
  sounds_.forget();
  stale_->add(Stale::surfaces);
  return !opened->same;
}

void ContentControl::cancel_opening() {
  opening_.cancel();
  content_->opening = false;
  messages_->say(log::Level::info, "loading was cancelled");
}

/// A live run goes on with the recording. A touch becomes a live run. An empty window waits for the object.
void ContentControl::play_recording(const std::string& path) {
  LiveEdit edit = content_->edit;
  if (content_->live && !edit.plays_recording()) content_->before = edit.options().source;
  content_->made.clear();
  edit.play_recording(path);
  const bool waits = edit.options().scene.empty();
  if (waits) messages_->say(log::Level::info, path + ": plays with the object that you open next");
  if (content_->live || waits) return change_run(std::move(edit));
  go_live(std::move(edit));
}

void ContentControl::remember(const std::string& path) {
  std::error_code fault;
  const std::string whole = fs::absolute(path, fault).lexically_normal().string();
  if (fault) return;
  std::vector<std::string>& recent = content_->recent;
  std::erase(recent, whole);
  recent.insert(recent.begin(), whole);
  if (recent.size() > most_recent) recent.resize(most_recent);
}

void ContentControl::update_status() {
  const LiveState state = content_->run.state;
  const bool loads = content_->opening || (content_->live && state == LiveState::loading);
  const std::optional<Doing> now = loads ? doing() : std::nullopt;
  content_->doing = now ? now->what : std::string();
  content_->done = now && now->total > 0
                       ? std::optional(static_cast<double>(now->done) / static_cast<double>(now->total))
                       : std::nullopt;
  if (loads) stale_->redraw();
  const bool has_object = !content_->edit.options().scene.empty();
  content_->can_start = content_->live ? state == LiveState::ended || state == LiveState::failed
                                       : has_object && static_cast<bool>(goes_live_);
  content_->empty =
      example_ || (touch_ && picture().solids.empty() && picture().transducers.empty() && !picture().skin);
}

}  // namespace palpa::viewer
