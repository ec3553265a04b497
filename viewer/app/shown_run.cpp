#include "viewer/app/shown_run.hpp"

#include <fmt/core.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "base/text.hpp"
#include "viewer/live/live_picture.hpp"

namespace palpa::viewer {
namespace {

constexpr const char* about_run = "run";  ///< what errors are about

/// The first folder of "recording-1", "recording-2", ... that does not exist.
std::string free_folder() {
  for (int i = 1;; ++i) {
    std::string name = fmt::format("recording-{}", i);
    std::error_code ignored;
    if (!std::filesystem::exists(name, ignored)) return name;
  }
}

/// The kinds that exist without the viewer, and those that the user controls in it.
LiveSession::Kinds with_hands(LiveSession::Kinds kinds, RecordingPlayer& recording, HeldFinger& finger) {
  kinds.sources.push_back(recording.source());
  kinds.sources.push_back(finger.source());
  return kinds;
}

}  // namespace

ShownRun::ShownRun(LiveSession::Kinds kinds, std::atomic<bool>& stop, std::function<void()> wake, RunStatus& status,
                   Messages& messages, Staleness& stale)
    : status_(&status),
      messages_(&messages),
      stale_(&stale),
      control_(with_hands(std::move(kinds), player_, finger_), stop, std::move(wake)) {}

bool ShownRun::begin() {
  setup::check(control_.next());
  if (control_.session()) see_recording();  // a recording ends with its run
  const auto lines = control_.begin();
  any_ = false;
  if (!lines) return false;
  for (const std::string& line : *lines)
    messages_->say(log::Level::info, line);
  if (holds_finger() && !std::exchange(told_of_finger_, true))
    messages_->say(
        log::Level::info,
        "The pointer holds a fingertip: move it down onto the object. M lets go of it, and H shows all keys.");
  if (control_.options().scene == placed_scene_) control_.session()->place(placing_.poses());
  status_->state = LiveState::loading;
  return true;
}

bool ShownRun::look() {
  LiveSession& session = *control_.session();
  session.look();
  const LinkWatch& link = session.link();
  const bool sounding = link.sound.sounding(), stuck = link.sound.stuck();
  const LiveState state = session.state();
  if (status_->sounding != sounding || status_->stuck != stuck || status_->state != state) stale_->redraw();
  status_->sounding = sounding;
  status_->stuck = stuck;
  status_->drives = link.drives;
  status_->silent_drives = link.silent;
  status_->state = state;
  status_->fault = state == LiveState::failed ? session.fault() : std::string();
  status_->playback = player_.now();
  see_recording();

  // Before asking for the scene, so that a snapshot's scene is there.
  const bool fresh = !held_ && session.take(), seen = !held_ && session.take_seen();
  new_frame_ = fresh || seen;
  fresh_ = fresh_ || fresh;
  any_ = any_ || fresh;
  if (!control_.take_scene()) {
    follow_messages();
    return false;
  }
  const Picture& rest = control_.scene()->picture;
  const std::string& scene = control_.options().scene;
  picture_ = rest;
  stale_->add(Stale::surfaces);
  placing_.begin(rest, holds_finger(), scene == placed_scene_);
  placed_scene_ = scene;
  for (const auto& [solid, pose] : session.take_moved())
    placing_.put(solid, pose);
  placed_.assign(placing_.poses().size(), Transform(1.0));
  session.place(placed_);  // it may have the poses of a scene with other solids
  place();
  return true;
}

void ShownRun::show_frame(std::uint64_t slot, bool depth) {
  if (!control_.scene() || !new_frame_) return;
  LiveSession& session = *control_.session();
  show_live(picture_, *control_.scene(), session.snapshot(), session.seen(), depth);
  status_->numbers = session.snapshot().numbers;
  show_slot(slot);
}

bool ShownRun::follow() {
  if (const std::optional<std::string> fault = control_.advance()) {
    stale_->redraw();
    if (!fault->empty()) messages_->say(log::Level::error, *fault, about_run);
  }
  if (control_.state() == RunState::running) messages_->settled(about_run);
  return control_.state() == RunState::ready;
}

void ShownRun::show_slot(std::uint64_t slot) {
  if (control_.scene()) show_live_slot(picture_, *control_.scene(), control_.session()->snapshot(), slot, scratch_);
  stale_->add(Stale::marks);
}

Sounding ShownRun::sounding(std::optional<std::uint64_t> slot) {
  const std::shared_ptr<const LiveScene>& scene = control_.scene();
  if (!scene || (status_->state != LiveState::running && !held_)) return {};
  const Snapshot& snapshot = control_.session()->snapshot();
  Sounding now = sounding_of(scene, snapshot);
  if (slot) now.slot = drive_of(*scene, snapshot.plan, *slot, scratch_);
  if (now.tip && holds_finger()) now.T_world_finger = finger_.pose();
  return now;
}

void ShownRun::place() {
  finger_.put(placing_.finger());
  if (!control_.scene() || placed_ == placing_.poses()) return;
  placed_ = placing_.poses();
  control_.session()->place(placed_);
  pose_solids(picture_, control_.scene()->picture, placed_);
  stale_->add(Stale::surfaces);
}

/// What messages have moved is shown where it is felt.
void ShownRun::follow_messages() {
  if (!control_.scene()) return;
  const std::map<std::uint32_t, Transform> moved = control_.session()->take_moved();
  for (const auto& [solid, pose] : moved) {
    placing_.put(solid, pose);
    if (solid < placed_.size()) placed_[solid] = pose;  // the session has it
  }
  if (moved.empty()) return;
  pose_solids(picture_, control_.scene()->picture, placed_);
  stale_->add(Stale::surfaces);
}

void ShownRun::record() {
  LiveSession* const session = control_.session();
  if (!session || status_->state != LiveState::running) return;
  if (!session->recording().empty()) return session->record({});
  const std::string folder = free_folder();
  session->record(folder);
  messages_->say(log::Level::info, folder + ": recording what the cameras see");
}

/// Shows what is being recorded, and how many frames an ended recording has.
void ShownRun::see_recording() {
  const LiveSession& session = *control_.session();
  std::string folder = session.recording();
  if (folder != status_->recording && !status_->recording.empty()) {
    const std::uint64_t frames = session.recorded();
    messages_->say(log::Level::info, fmt::format("{}: {}", status_->recording, counted(frames, "frame")));
    if (frames > 0) made_ = status_->recording;
  }
  status_->recording = std::move(folder);
  status_->recorded = session.recorded();
}

}  // namespace palpa::viewer
