#include "viewer/sound/sounds.hpp"

#include <utility>

namespace palpa::viewer {

Change Sounds::look(const Sounding& now, const ViewState& state, bool spectrum, Picture& picture, double now_s) {
  Change change;
  busy_ = false;
  if (state.layers.shows(Layer::heat) && now.layout && !skin_.empty()) {
    if (!heat_) heat_.emplace(skin_, now.air);
    change |= heat_->look(now, picture);
    busy_ = busy_ || heat_->busy();
    fault_ = heat_->fault();
  }
  if (state.layers.shows(Layer::slice) && now.layout) {
    if (!slice_) slice_.emplace(device_);
    change |= slice_->look(now, state.slice, picture, now_s);
    busy_ = busy_ || slice_->busy();
    if (fault_.empty()) fault_ = slice_->fault();
  }
  if (spectrum) {
    if (!felt_) felt_.emplace();
    if (felt_->look(now, now_s)) {
      spectra_ = felt_->spectra();
      change.marks = true;
    }
    busy_ = busy_ || felt_->busy();
  }
  return change;
}

void Sounds::forget() {
  if (heat_) heat_->forget();
  if (slice_) slice_->forget();
}

std::string Sounds::fault() {
  if (fault_ == told_) return {};
  told_ = fault_;
  return told_;
}

}  // namespace palpa::viewer
