// Opens things while something is shown: dropped files, scenes that were written again, recordings that were made.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/error.hpp"
#include "viewer/app/app.hpp"
#include "viewer/options/touch_edit.hpp"

namespace palpa::viewer {
namespace {

constexpr const char* about_opening = "opening";  ///< what errors are about
constexpr std::size_t most_recent = 6;

}  // namespace

void App::open(const std::string& path, double now_s) {
  const std::filesystem::path file(path);
  const std::string ending = file.extension().string();
  std::error_code ignored;
  if (ending == ".glb" || ending == ".gltf") return open_scene(path);
  if (ending == ".ply") return open_skin(path, now_s);
  if (!std::filesystem::is_directory(file, ignored) && file.filename() != "recording.toml")
    return say(log::Level::warning, fmt::format("{}: is not a .glb, a .gltf, a .ply or a recording", path), now_s,
               about_opening);
  if (!data_.live && !around_.goes_live)
    return say(log::Level::warning, "a recording needs --source: start palpa-viewer with it", now_s);
  stale_.redraw();
  opening_.begin_recording(path);
}

/// The run or the picture stays until the file is loaded and found to be a scene. In an empty window, a live run of it
/// begins.
void App::open_scene(const std::string& path) {
  stale_.redraw();
  LiveEdit edit = data_.edit;
  edit.open_scene(path);
  const bool same = edit.runs_as(data_.edit);
  if (data_.live || (data_.empty && around_.goes_live)) {
    if (goes_together(edit)) opening_.begin_scene(edit.options(), same);
    return;
  }
  TouchEdit touch(options_);
  touch.open_scene(path);
  opening_.begin_touch(touch.options(), same);
}

/// A PLY is what touches: the finger that the pointer holds, or the skin of a single touch.
void App::open_skin(const std::string& path, double now_s) {
  if (data_.live || data_.empty) {
    set_option({"--source", "mouse:" + path}, now_s);
    if (data_.empty) say(log::Level::info, path + ": touches the object that you open next", now_s);
    return;
  }
  try {
    TouchEdit touch(options_);
    touch.use_points(path);
    touch.check();
    stale_.redraw();
    opening_.begin_touch(touch.options(), true);
  } catch (const Error& error) {
    say(log::Level::error, error.what(), now_s, about_opening);
  }
}

/// Opens a scene that was written again. A run that has ended stays silent until a person starts it. A run that failed
/// before it had a scene has never sounded, and the new file is probably the repair, so this run begins again.
void App::open_again(const std::string& scene, double now_s) {
  const bool over = run_.state() == RunState::ended || (run_.state() == RunState::failed && run_.scene());
  if (!data_.live || !over) return open(scene, now_s);
  say(log::Level::info, fmt::format("{}: was written again; Start begins a run with it", scene), now_s);
}

void App::advance_opening(double now_s) {
  data_.opening = opening_.busy();
  std::optional<Opened> opened = opening_.take();
  if (!opened) return;
  stale_.redraw();
  if (!opened->fault.empty()) return say(log::Level::error, opened->fault, now_s, about_opening);
  settled(about_opening);
  remember_file(opened->path);
  if (opened->kind == Opened::Kind::recording) return play_recording(opened->path);
  LiveEdit edit = data_.edit;
  edit.open_scene(opened->path);
  if (opened->kind == Opened::Kind::scene && !data_.live) {
    data_.edit = std::move(edit);
    return start_run();
  }
  change_run(std::move(edit), opened->same);
  if (opened->kind != Opened::Kind::touch) return;
  show_ = std::move(opened->show);
  options_ = std::move(*opened->touch);
  sounds_.forget();
  if (!opened->same) data_.asked.frame = true;
  stale_.add(Stale::surfaces);
}

void App::remember_file(const std::string& path) {
  std::error_code fault;
  const std::string whole = std::filesystem::absolute(path, fault).lexically_normal().string();
  if (fault) return;
  std::erase(data_.recent, whole);
  data_.recent.insert(data_.recent.begin(), whole);
  if (data_.recent.size() > most_recent) data_.recent.resize(most_recent);
}

void App::cancel_opening() {
  opening_.cancel();
  data_.opening = false;
  say(log::Level::info, "loading was cancelled", now_s_);
}

/// A live run goes on with the recording. A touch becomes a live run. An empty window waits for the object.
void App::play_recording(const std::string& path) {
  LiveEdit edit = data_.edit;
  if (data_.live && !data_.playback) data_.before = edit.options().source;
  data_.made.clear();
  edit.play_recording(path);
  const bool waits = edit.options().scene.empty();
  if (waits) say(log::Level::info, path + ": plays with the object that you open next", now_s_);
  if (data_.live || waits) return change_run(std::move(edit));
  go_live(std::move(edit));
}

}  // namespace palpa::viewer
