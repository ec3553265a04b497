#include "viewer/options/touch_edit.hpp"

namespace palpa::viewer {

void TouchEdit::check() const {
  viewer::check(options_);
}

void TouchEdit::open_scene(const std::string& file) {
  if (file != options_.input.scene) {
    options_.input.gltf_scene.reset();
    options_.given.erase("--gltf-scene");
  }
  options_.input.scene = file;
  options_.given["--scene"] = {file};
}

void TouchEdit::use_points(const std::string& file) {
  line::Given given = options_.given;
  given.erase("--depth");
  given["--points"] = {file};
  options_ = options_of(given);
}

void TouchEdit::set(const std::string& option, const std::optional<std::string>& text) {
  line::Given given = options_.given;
  line::give(given, option, text);
  options_ = options_of(given);
}

}  // namespace palpa::viewer
