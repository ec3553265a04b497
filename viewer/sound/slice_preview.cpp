#include "viewer/sound/slice_preview.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "viewer/picture/field_marks.hpp"

namespace palpa::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double quick_s = 0.05;  // fast enough for a hand
constexpr double rested_s = 0.2;  // time without a change after which it becomes finer
constexpr const char* title = "sound in the plane";
constexpr double told_late_s = 0.5;  // an older picture is marked

/// The field of a layout, kept as long as the layout stays the same.
struct Kept {
  gpu::DeviceOptions options;
  std::unique_ptr<gpu::Device> device;
  std::shared_ptr<const array::Layout> layout;
  std::unique_ptr<FieldSlice> field;

  SliceAnswer answer(const SliceQuestion& question) {
    if (!device) device = std::make_unique<gpu::Device>(options);
    if (layout != question.layout) {
      field.reset();
      field = std::make_unique<FieldSlice>(*device, *question.layout, question.air, question.directivity,
                                           SlicePreview::finest);
      layout = question.layout;
    }
    const Clock::time_point begin = Clock::now();
    SliceAnswer answer;
    answer.field = field->sample(question.slice, question.drive, question.along);
    answer.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    return answer;
  }
};

bool same_drive(std::span<const array::TransducerDrive> a, std::span<const array::TransducerDrive> b) {
  return std::ranges::equal(a, b, [](const array::TransducerDrive& one, const array::TransducerDrive& other) {
    return one.amplitude == other.amplitude && one.phase == other.phase;
  });
}

}  // namespace

SlicePreview::SlicePreview(gpu::DeviceOptions device)
    : answers_([kept = std::make_shared<Kept>(Kept{std::move(device), {}, {}, {}})](
                   const SliceQuestion& question, const std::atomic<bool>&) { return kept->answer(question); }) {}

std::uint32_t SlicePreview::quick_along() const {
  constexpr double unknown = 48;
  const double along = per_sample_s_ > 0 ? std::sqrt(quick_s / per_sample_s_) : unknown;
  return static_cast<std::uint32_t>(std::clamp(std::floor(along / 8) * 8, double{coarsest}, double{finest} / 2));
}

Change SlicePreview::look(const Sounding& now, const SliceState& slice, Picture& picture, double now_s) {
  busy_ = false;
  if (!now.layout || now.slot.empty()) {
    asked_.reset();
    return {.marks = hide_slice(picture)};
  }
  Change change;
  const bool computing = answers_.stale();  // read first: answers from now on are for the next look()
  const std::shared_ptr<const SliceAnswer> newest = answers_.newest();
  if (asked_ && newest->number > shown_ && !computing) {
    shown_ = newest->number;
    if (newest->fault.empty()) {
      const SliceField& field = newest->field;
      per_sample_s_ = newest->seconds / static_cast<double>(std::max<std::size_t>(field.pressures.size(), 1));
      rest_until_s_ = now_s + std::min(newest->seconds, 1.0);
      shown_s_ = now_s;
      current_ = true;
      show_slice(picture, asked_->slice, field.grid, field.pressures);
      change.marks = true;
    }
  }
  if (!computing) fault_ = newest->fault;
  const bool moved = !asked_ || asked_->slice != slice;
  const bool same = !moved && asked_->layout == now.layout && same_drive(asked_->drive, now.slot);
  if (same && !computing && (asked_->along >= finest || !fault_.empty())) {
    change.marks =
        mark(picture, Layer::slice, title, fault_.empty() ? Standing::fresh : Standing::failed) || change.marks;
    moved_s_ = now_s;
    return change;
  }
  busy_ = true;
  if (!same) {
    if (!computing && (moved || now_s >= rest_until_s_)) {
      asked_ = {now.layout, now.air, now.drive.directivity, slice, {now.slot.begin(), now.slot.end()}, quick_along()};
      answers_.ask(*asked_);
      moved_s_ = now_s;
      current_ = false;
    }
  } else if (!computing && now_s >= moved_s_ + rested_s) {
    asked_->along = std::min(2 * asked_->along, finest);
    answers_.ask(*asked_);
  }
  const bool late = (!same || !current_) && now_s > shown_s_ + told_late_s;
  change.marks = mark(picture, Layer::slice, title, late ? Standing::stale : Standing::fresh) || change.marks;
  return change;
}

void SlicePreview::forget() {
  asked_.reset();
  shown_ = answers_.newest()->number;
}

}  // namespace palpa::viewer
