// What is opened while something is shown: files that are dropped, scenes that are written anew, recordings that are
// made.
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "sensing/recording.hpp"
#include "setup/load.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {
namespace {

constexpr const char* scene_option = "--scene";

/// The first folder of "recording-1", "recording-2", ... that is not there.
std::string free_folder() {
  for (int i = 1;; ++i) {
    std::string name = fmt::format("recording-{}", i);
    std::error_code ignored;
    if (!std::filesystem::exists(name, ignored)) return name;
  }
}

}  // namespace

void App::open(const std::string& path, double now_s) {
  const std::filesystem::path file(path);
  const std::string ending = file.extension().string();
  std::error_code ignored;
  if (ending == ".glb" || ending == ".gltf") return open_scene(path);
  if (!std::filesystem::is_directory(file, ignored) && file.filename() != "recording.toml")
    return say(log::Level::warning, fmt::format("{}: is no .glb, .gltf or recording", path), now_s);
  if (!desk_.live && !around_.goes_live)
    return say(log::Level::warning, "a recording needs --source: start with one", now_s);
  dirty_ = true;
  opened_ = {.path = path, .recording = true};
  loader_->begin([path] { sensing::load_recording(path); });
}

/// What runs, or is shown, goes on until the scene is there and was found to be one.
void App::open_scene(const std::string& path) {
  dirty_ = true;
  setup::Given given = desk_.given;
  const bool same = given.contains(scene_option) && given[scene_option] == std::vector{path};
  given[scene_option] = {path};
  if (!same) given.erase("--gltf-scene");
  opened_ = {.path = path, .same = same};
  if (desk_.live) {
    setup::LiveOptions options;
    try {
      options = live_options(given);
    } catch (const Error& error) {
      return say(log::Level::error, error.what(), now_s_);
    }
    return loader_->begin([options] { setup::load_solids(options.scene, options.gltf_scene, options.solids); });
  }
  opened_.options = options_;
  opened_.options->input.scene = path;
  if (!given.contains("--gltf-scene")) opened_.options->input.gltf_scene.reset();
  opened_.show = std::make_shared<std::unique_ptr<Show>>();
  loader_->begin([show = opened_.show, options = *opened_.options] { *show = std::make_unique<Show>(options); });
}

void App::advance_opening(double now_s) {
  desk_.opening = loader_->busy();
  const std::optional<std::string> fault = loader_->take();
  if (!fault) return;
  dirty_ = true;
  if (!fault->empty()) return say(log::Level::error, *fault, now_s);
  if (opened_.recording) return play_recording(now_s);
  desk_.given[scene_option] = {opened_.path};
  if (!opened_.same) desk_.given.erase("--gltf-scene");
  if (desk_.live) {
    anew_ = anew_ || opened_.same;
    return;
  }
  if (!opened_.show) return;
  show_ = std::move(*opened_.show);
  options_ = *std::exchange(opened_.options, std::nullopt);
  opened_.show.reset();
  sounds_.forget();
  desk_.asked.frame = true;
  surfaces_changed();
}

void App::cancel_opening() {
  loader_->cancel();
  desk_.opening = false;
  say(log::Level::info, "what was being loaded is not opened", now_s_);
}

/// A live run goes on with it, a touch becomes one: what was said of the touch alone is of no account any more.
void App::play_recording(double now_s) {
  setup::Given given = desk_.live ? desk_.given : setup::known_to(live_table(), desk_.given);
  given["--source"] = {"recording:" + opened_.path};
  given.erase("--noise-free");
  if (desk_.live) return void(desk_.given = std::move(given));
  if (!given.contains("--tune")) given.erase("--spot");  // it was of --spectrum
  try {
    live_options(given);
  } catch (const Error& error) {
    return say(log::Level::error, error.what(), now_s);
  }
  around_.goes_live();
  desk_.live = true;
  desk_.given = std::move(given);
  live_picture_ = show_->picture();
  show_.reset();
  sounds_.forget();
  desk_.state.time.playing = true;
  start();
}

/// A scene that was written anew is read anew, once it has not changed for a while: editors write in pieces.
void App::reload(double now_s) {
  constexpr double every_s = 1;
  next_reload_s_ = now_s + every_s;
  const auto scene = desk_.given.find(scene_option);
  if (scene == desk_.given.end()) return;
  const std::string path = scene->second.front();
  std::error_code fault;
  const std::filesystem::file_time_type time = std::filesystem::last_write_time(path, fault);
  if (fault) return;
  const WrittenScene before = std::exchange(scene_written_, {path, time});
  if (before.path != path) {
    written_ = false;  // another file: nobody knows what it was before
  } else if (before.time != time) {
    written_ = true;
  } else if (std::exchange(written_, false)) {
    open(path, now_s);
  }
}

/// What is being written down, and of what has ended how much it is.
void App::tell_recording(double now_s) {
  std::string folder = live_->recording();
  if (folder != desk_.recording && !desk_.recording.empty())
    say(log::Level::info, fmt::format("{}: {} frames", desk_.recording, live_->recorded()), now_s);
  desk_.recording = std::move(folder);
  desk_.recorded = live_->recorded();
}

/// Begins to write down what is seen, or ends it.
void App::record(double now_s) {
  if (!live_ || desk_.live_state != LiveState::running) return;
  if (!live_->recording().empty()) return live_->record({});
  const std::string folder = free_folder();
  live_->record(folder);
  say(log::Level::info, folder + ": records what the cameras see", now_s);
}

}  // namespace palpa::viewer
