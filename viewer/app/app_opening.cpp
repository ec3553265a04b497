// Opens things while something is shown: dropped files, scenes that were written again, recordings that were made.
#include <fmt/core.h>

#include <filesystem>
#include <utility>

#include "viewer/app/app.hpp"

namespace palpa::viewer {

void App::open(const std::string& path, double now_s) {
  const std::filesystem::path file(path);
  const std::string ending = file.extension().string();
  std::error_code ignored;
  if (ending == ".glb" || ending == ".gltf") return open_scene(path);
  if (!std::filesystem::is_directory(file, ignored) && file.filename() != "recording.toml")
    return say(log::Level::warning, fmt::format("{}: is not a .glb, a .gltf or a recording", path), now_s);
  if (!desk_.live && !around_.goes_live)
    return say(log::Level::warning, "a recording needs --source: start palpa-viewer with it", now_s);
  stale_.redraw();
  opening_.begin_recording(path);
}

/// The run or the picture stays until the file is loaded and found to be a scene.
void App::open_scene(const std::string& path) {
  stale_.redraw();
  LiveEdit edit = desk_.edit;
  edit.open_scene(path);
  const bool same = edit.runs_as(desk_.edit);
  if (desk_.live) {
    if (goes_together(edit)) opening_.begin_scene(edit.options(), same);
    return;
  }
  ViewerOptions touch = options_;
  touch.input.scene = path;
  touch.input.gltf_scene = edit.options().gltf_scene;
  opening_.begin_touch(touch, same);
}

/// Opens a scene that was written again. A run that has ended stays silent until a person starts it. A run that failed
/// before it had a scene has never sounded, and the new file is probably the repair, so this run begins again.
void App::open_again(const std::string& scene, double now_s) {
  const bool over = run_.state() == RunState::ended || (run_.state() == RunState::failed && run_.scene());
  if (!desk_.live || !over) return open(scene, now_s);
  say(log::Level::info, fmt::format("{}: was written again; Start begins a run with it", scene), now_s);
}

void App::advance_opening(double now_s) {
  desk_.opening = opening_.busy();
  std::optional<Opened> opened = opening_.take();
  if (!opened) return;
  stale_.redraw();
  if (!opened->fault.empty()) return say(log::Level::error, opened->fault, now_s);
  if (opened->kind == Opened::Kind::recording) return play_recording(opened->path);
  LiveEdit edit = desk_.edit;
  edit.open_scene(opened->path);
  change_run(std::move(edit), opened->same);
  if (opened->kind != Opened::Kind::touch) return;
  show_ = std::move(opened->show);
  options_ = std::move(*opened->touch);
  sounds_.forget();
  desk_.asked.frame = true;
  stale_.add(Stale::surfaces);
}

void App::cancel_opening() {
  opening_.cancel();
  desk_.opening = false;
  say(log::Level::info, "loading was cancelled", now_s_);
}

/// A live run goes on with the recording. A touch becomes a live run, and options that only concern the touch are
/// ignored from then on.
void App::play_recording(const std::string& path) {
  LiveEdit edit = desk_.edit;
  edit.play_recording(path);
  if (desk_.live) return change_run(std::move(edit));
  edit.leave_touch();
  if (!goes_together(edit)) return;
  around_.goes_live();
  desk_.live = true;
  desk_.edit = std::move(edit);
  live_.picture = show_->picture();
  show_.reset();
  sounds_.forget();
  desk_.state.time.playing = true;
  run_.start(desk_.edit.options());
  begin_run();
}

}  // namespace palpa::viewer
