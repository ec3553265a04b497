#include "viewer/live/live_edit.hpp"

#include <algorithm>
#include <utility>

#include "viewer/live/live_line.hpp"

namespace palpa::viewer {

LiveEdit::LiveEdit(const line::Given& line) : options_(values_of(line)), line_(line::known_to(live_table(), line)) {}

void LiveEdit::check() const {
  check_live(line_, options_);
}

void LiveEdit::open_scene(const std::string& file) {
  if (file != options_.scene) replace_scene(file);
}

void LiveEdit::replace_scene(const std::string& file) {
  options_.scene = file;
  line_["--scene"] = {file};
  options_.gltf_scene.reset();
  line_.erase("--gltf-scene");
}

void LiveEdit::play_recording(const std::string& folder) {
  options_.source = "recording:" + folder;
  line_["--source"] = {options_.source};
  options_.noise_free = false;
  line_.erase("--noise-free");
}

void LiveEdit::leave_touch() {
  if (options_.touch.tune) return;  // tuning needs the spot in a live run, too
  options_.touch.spot_m.reset();
  line_.erase("--spot");
}

std::optional<std::string> LiveEdit::text(const std::string& option) const {
  for (const line::Given* part : {&line_, &copied_only_}) {
    if (const auto found = part->find(option); found != part->end())
      return found->second.empty() ? std::string() : found->second.front();
  }
  return std::nullopt;
}

void LiveEdit::set(const std::string& option, const std::optional<std::string>& text) {
  const bool runs = std::ranges::find(live_table(), option, &line::OptionInfo::name) != live_table().end();
  line::Given part = runs ? line_ : copied_only_;
  line::give(part, option, text);
  if (!runs) {
    check_copied(part);
    copied_only_ = std::move(part);
    return;
  }
  options_ = values_of(part);
  line_ = std::move(part);
}

bool LiveEdit::runs_as(const LiveEdit& other) const {
  line::Given mine = line_, theirs = other.line_;
  mine.erase("--ceiling");
  theirs.erase("--ceiling");
  return mine == theirs;
}

std::string LiveEdit::command() const {
  return run_command(line_, copied_only_);
}

}  // namespace palpa::viewer
