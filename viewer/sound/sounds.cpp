#include "viewer/sound/sounds.hpp"

#include <atomic>

#include "acoustics/field/array_field.hpp"
#include "setup/sessions/touch_schedule.hpp"

namespace palpa::viewer {
namespace {

constexpr double every_s = 0.25;

SpectraAnswer answer(const SpectraQuestion& question) {
  acoustics::SpectrumOptions options;
  std::optional<acoustics::ArrayField> field;
  if (question.layout && !question.layout->transducers.empty() && !question.spot_m)
    options.field = &field.emplace(*question.layout, question.drive);
  options.fwhm_m = question.spot_m.value_or(options.fwhm_m);
  SpectraAnswer answer;
  answer.spectra = setup::spectra_of(question.schedule, options);
  return answer;
}

}  // namespace

Spectra::Spectra()
    : answers_([](const SpectraQuestion& question, const std::atomic<bool>&) { return answer(question); }) {}

bool Spectra::look(const Sounding& now, double now_s) {
  bool fresh = false;
  const std::shared_ptr<const SpectraAnswer> newest = answers_.newest();
  if (newest->number > shown_) {
    shown_ = newest->number;
    spectra_ = newest->spectra;
    fault_ = newest->fault;
    fresh = true;
  }
  if (now.schedule == nullptr || now.schedule->voice_count == 0) {
    fresh = fresh || !spectra_.empty();
    spectra_.clear();
    asked_.reset();
    return fresh;
  }
  if (answers_.stale() || now_s < next_s_) return fresh;
  if (asked_ && asked_->layout == now.layout && asked_->spot_m == now.spot_m && alike(asked_->schedule, *now.schedule))
    return fresh;
  asked_ = {*now.schedule, now.layout, now.drive, now.spot_m};
  answers_.ask(*asked_);
  next_s_ = now_s + every_s;
  return fresh;
}

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
