#include "setup/tasks/register_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <iterator>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "sensing/joints/capsules.hpp"
#include "sensing/joints/tracker.hpp"
#include "setup/tasks/rigid_fit.hpp"

namespace palpa::setup {
namespace {

/// More than trackers err by within a decimetre.
constexpr double most_residual_m = 10e-3;
/// The triangles of the tips are at least this high.
constexpr double least_height_m = 15e-3;

/// The fingertip whose contacts with the cube let the focus sound.
const sensing::Capsule fingertip{{0, 6e-3, 0}, {0, 60e-3, 0}, 8e-3, 8e-3};

class TouchingSource final : public sensing::DepthSource {
 public:
  TouchingSource(std::unique_ptr<sensing::Tracker> tracker, FocusTouches& touches)
      : tracker_(std::move(tracker)), touches_(&touches) {}

  const std::vector<sensing::Camera>& cameras() const override { return none_; }

  bool next(sensing::FrameSet& out, double timeout_s) override {
    out.frames.clear();
    out.capsules.clear();
    if (!tracker_->next(frame_, out.tracked, out.sequence, timeout_s)) return false;
    if (!out.tracked) return true;
    out.time_s = frame_.time_s;
    touches_->see(frame_);
    if (frame_.hands.size() == 1) out.capsules.push_back(fingertip);
    return true;
  }

 private:
  std::unique_ptr<sensing::Tracker> tracker_;
  FocusTouches* touches_;
  std::vector<sensing::Camera> none_;
  sensing::TrackedFrame frame_;
};

}  // namespace

Vec3 towards_array(const array::Layout& layout, const Vec3& focus) {
  Vec3 sum(0);
  for (const array::Transducer& transducer : layout.transducers)
    sum += glm::normalize(transducer.position - focus);
  sum /= static_cast<double>(layout.transducers.size());
  const double length = glm::length(sum);
  return length > 0.5 ? sum / length : Vec3(0);
}

Registration register_tracker(std::span<const TouchedFocus> touches, const array::Layout& layout) {
  std::vector<Vec3> tips, places;
  for (const TouchedFocus& touch : touches) {
    tips.push_back(touch.tip_m);
    places.push_back(touch.focus_m - touch.radius_m * towards_array(layout, touch.focus_m));
  }
  if (const double height_m = height_of(tips); height_m < least_height_m) {
    throw failure(
        fmt::format("--nudge: the tracker saw the fingertip nearly on a line, in a triangle {:.0f} mm high, and "
                    "{:.0f} mm are needed: nothing is saved; touch each focus where it is felt",
                    height_m * 1e3, least_height_m * 1e3));
  }
  const RigidFit fit = fit_rigid(tips, places);
  if (!(fit.residual_m <= most_residual_m)) {
    const auto worst = std::ranges::max_element(fit.off_m);
    throw failure(
        fmt::format("--nudge: the touches do not fit the foci: {:.1f} mm off (rms), at most {:.0f}; the "
                    "worst is focus {} with {:.1f} mm: nothing is saved",
                    fit.residual_m * 1e3, most_residual_m * 1e3, worst - fit.off_m.begin() + 1, *worst * 1e3));
  }
  return {fit.T_to_from, fit.residual_m, fit.off_m};
}

session::SourceKind FocusTouches::source() {
  return {.name = "joints",
          .help = "joints:udp:PORT or joints:FILE: hands from a tracker",
          .open = [this](const std::string& argument, const session::SourceSetting& setting) {
            return std::make_unique<TouchingSource>(sensing::open_tracker(argument, setting.paced), *this);
          }};
}

session::OwnMethod FocusTouches::method() {
  return [this](const touch::Touch&, const touch::Finger& finger, touch::Placement& out) {
    const std::lock_guard lock(mutex_);
    out.foci.assign(1, {.position = glm::vec3(focus()), .points = finger.contact_count});
    out.complete = true;
    out.together = false;
  };
}

Vec3 FocusTouches::focus() const {
  return registration_foci[std::min(touches_.size(), registration_foci.size() - 1)] + offset_;
}

void FocusTouches::nudge(const Vec3& offset) {
  const std::lock_guard lock(mutex_);
  offset_ = offset;
}

void FocusTouches::see(const sensing::TrackedFrame& frame) {
  constexpr double kept_s = 1;
  const std::lock_guard lock(mutex_);
  if (frame.hands.size() != 1) return tips_.clear();
  const sensing::TrackedHand& hand = frame.hands.front();
  if (!tips_.empty() && frame.time_s <= tips_.back().time_s) tips_.clear();
  tips_.push_back({frame.time_s, hand.joints[sensing::index_tip_joint], hand.radii_m[sensing::index_tip_joint]});
  while (tips_.front().time_s < frame.time_s - kept_s)
    tips_.pop_front();
}

std::string FocusTouches::take(double time_s) {
  constexpr double mean_over_s = 0.25, most_sway_m = 5e-3;
  constexpr std::size_t least_frames = 3;
  const std::lock_guard lock(mutex_);
  if (touches_.size() == registration_foci.size()) return {};
  std::vector<Tip> tips;
  std::ranges::copy_if(tips_, std::back_inserter(tips),
                       [&](const Tip& tip) { return tip.time_s <= time_s && tip.time_s > time_s - mean_over_s; });
  if (tips.size() < least_frames) return "the tracker must see one hand";
  TouchedFocus touched{.focus_m = focus()};
  for (const Tip& tip : tips) {
    touched.tip_m += tip.place_m / static_cast<double>(tips.size());
    touched.radius_m += tip.radius_m / static_cast<double>(tips.size());
  }
  const auto sways = [&](const Tip& tip) { return glm::distance(tip.place_m, touched.tip_m) > most_sway_m; };
  if (std::ranges::any_of(tips, sways)) return "hold the fingertip still";
  touches_.push_back(touched);
  offset_ = Vec3(0);
  return {};
}

std::string FocusTouches::line() const {
  const std::lock_guard lock(mutex_);
  if (touches_.size() == registration_foci.size()) return {};
  return fmt::format("focus {} of {}", touches_.size() + 1, registration_foci.size());
}

std::optional<std::vector<TouchedFocus>> FocusTouches::touches() const {
  const std::lock_guard lock(mutex_);
  return touches_.size() == registration_foci.size() ? std::optional(touches_) : std::nullopt;
}

}  // namespace palpa::setup
