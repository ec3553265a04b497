#include "viewer/app/opening.hpp"

#include <utility>

#include "sensing/recording.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::viewer {

void Opening::begin_scene(const setup::LiveOptions& options, bool same) {
  opened_ = {.kind = Opened::Kind::scene, .path = options.scene, .same = same};
  loader_.begin([options] { setup::load_solids(options.scene, options.gltf_scene, options.solids); });
}

void Opening::begin_touch(const ViewerOptions& options, bool same) {
  opened_ = {.kind = Opened::Kind::touch, .path = options.input.scene, .same = same, .options = options};
  touch_ = std::make_shared<std::unique_ptr<ShownTouch>>();
  loader_.begin([touch = touch_, options] { *touch = std::make_unique<ShownTouch>(options); });
}

void Opening::begin_recording(const std::string& path) {
  opened_ = {.kind = Opened::Kind::recording, .path = path};
  loader_.begin([path] { sensing::load_recording(path); });
}

std::optional<Opened> Opening::take() {
  std::optional<std::string> fault = loader_.take();
  if (!fault) return std::nullopt;
  Opened opened = std::exchange(opened_, {});
  opened.fault = std::move(*fault);
  if (opened.kind == Opened::Kind::touch) opened.touch = std::move(*touch_);
  touch_.reset();
  return opened;
}

bool SceneWatch::look(const std::string& file, double now_s) {
  constexpr double every_s = 1;
  if (now_s < next_s_) return false;
  next_s_ = now_s + every_s;
  if (file.empty()) return false;
  const setup::SceneState state = setup::look_at_scene(file);
  if (state.front() == setup::SceneState::value_type{}) return false;  // there is no such file
  const bool same_file = std::exchange(file_, file) == file;
  const bool written = std::exchange(state_, state) != state && same_file;
  const bool settled = same_file && !written && unsettled_;
  unsettled_ = written;
  return settled;
}

}  // namespace palpa::viewer
