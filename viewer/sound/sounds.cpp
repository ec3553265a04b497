#include "viewer/sound/sounds.hpp"

namespace palpa::viewer {

void Sounds::set_finger(const std::string& file) {
  if (file == finger_) return;
  finger_ = file;
  heat_.reset();
}

void Sounds::keep_fault(const std::string& fault) {
  if (!fault.empty() && told_.insert(fault).second) faults_.push_back(fault);
}

Change Sounds::look(const Sounding& now, const ViewState& state, bool spectrum, Picture& picture, double now_s) {
  Change change;
  busy_ = false;
  const auto look_at = [&](const auto& sound) {
    busy_ = busy_ || sound.busy();
    keep_fault(sound.fault());
  };
  if (state.layers.shows(Layer::heat) && now.layout && !finger_.empty()) {
    if (!heat_) heat_.emplace(finger_, now.air);
    change |= heat_->look(now, picture, state.skin_colour);
    look_at(*heat_);
  }
  if (state.layers.shows(Layer::slice) && now.layout) {
    if (!slice_) slice_.emplace(device_);
    change |= slice_->look(now, state.slice, picture, now_s);
    look_at(*slice_);
  }
  if (spectrum) {
    if (!felt_) felt_.emplace();
    if (felt_->look(now, now_s)) {
      spectra_ = felt_->spectra();
      change.marks = true;
    }
    look_at(*felt_);
  }
  return change;
}

void Sounds::forget() {
  if (heat_) heat_->forget();
  if (slice_) slice_->forget();
}

}  // namespace palpa::viewer
