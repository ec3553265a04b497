#include "setup/tasks/register_cameras.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iterator>
#include <limits>
#include <utility>

#include "array/layouts/board_mesh.hpp"
#include "base/error.hpp"
#include "base/random.hpp"
#include "sensing/find_fingertip.hpp"
#include "sensing/joints/capsules.hpp"
#include "sensing/synthetic.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/frames.hpp"
#include "setup/tasks/register_tracker.hpp"
#include "setup/tasks/rigid_fit.hpp"

namespace palpa::setup {
namespace {

/// People find a focus to some millimetres.
constexpr double usual_off_m = 5e-3, most_residual_m = 12e-3, least_height_m = 30e-3;
/// A touch that is so far from where the others say, and so many times their residual, was another place.
constexpr double least_wrong_m = 12e-3, wrong_times = 3;
constexpr std::uint64_t background_frames = 45;
/// Frames of a touch that are kept; their mean counts.
constexpr std::size_t most_frames = 6, least_frames = 3;
constexpr double mean_over_s = 0.25, most_sway_m = 6e-3;

/// Where fingers point to: to the array, or down if the array is all around.
Vec3 way_at(const array::Layout& layout, const Vec3& focus) {
  const Vec3 way = towards_array(layout, focus);
  return way == Vec3(0) ? Vec3(0, -1, 0) : way;
}

/// The fingertip in those frames in which it is found, on average.
std::optional<sensing::Fingertip> mean_tip(const std::vector<std::vector<Vec3>>& frames, const Vec3& way) {
  sensing::Fingertip mean;
  double count = 0;
  for (const std::vector<Vec3>& hand : frames) {
    const auto tip = sensing::find_fingertip(hand, way);
    if (!tip) continue;
    mean.centre_m += tip->centre_m;
    mean.radius_m += tip->radius_m;
    ++count;
  }
  if (count == 0) return std::nullopt;
  mean.centre_m /= count;
  mean.radius_m /= count;
  return mean;
}

/// A camera that nobody has placed yet stands upright: its image's downward axis is the world's.
Transform pose_to_begin(const sensing::Camera& guess) {
  if (guess.T_world_camera != Transform(1.0)) return guess.T_world_camera;
  return glm::rotate(Transform(1.0), glm::radians(180.0), Vec3(1, 0, 0));
}

/// The fingertips that a camera saw, where the foci say they were, and the numbers of these foci from 0.
struct Tips {
  std::vector<Vec3> seen, places;
  std::vector<std::size_t> foci;

  bool fix_a_pose() const { return seen.size() >= least_touches && height_of(seen) >= least_height_m; }
  RigidFit fit() const { return fit_rigid_robustly(seen, places, usual_off_m); }
  Tips without(std::size_t one) const {
    Tips rest = *this;
    const auto at = static_cast<std::ptrdiff_t>(one);
    rest.seen.erase(rest.seen.begin() + at);
    rest.places.erase(rest.places.begin() + at);
    rest.foci.erase(rest.foci.begin() + at);
    return rest;
  }
};

/// The tips with the array where this pose says it is. The skin that touches a focus is the end of the finger on the
/// way to the array.
Tips tips_from(const Transform& pose, std::span<const SeenTouch> touches, const array::Layout& layout) {
  Tips tips;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Vec3 way = way_at(layout, touches[i].focus_m);
    const auto tip = mean_tip(touches[i].frames, glm::normalize(transform_direction(glm::inverse(pose), way)));
    if (!tip) continue;
    tips.seen.push_back(tip->centre_m);
    tips.places.push_back(touches[i].focus_m - tip->radius_m * way);
    tips.foci.push_back(i);
  }
  return tips;
}

/// Leaves out the touch that stands out most: one that is far from where all others, together, say that it was. At most
/// one: of two, either might be right.
void leave_out_wrong(Tips& tips, RigidFit& fit, TouchedCamera& camera) {
  if (tips.seen.size() <= least_touches) return;
  const auto worst = static_cast<std::size_t>(std::ranges::max_element(fit.off_m) - fit.off_m.begin());
  const Tips rest = tips.without(worst);
  if (!rest.fix_a_pose()) return;
  const RigidFit others = rest.fit();
  const double off_m = glm::distance(transform_point(others.T_to_from, tips.seen[worst]), tips.places[worst]);
  if (off_m < least_wrong_m || off_m < wrong_times * others.residual_m) return;
  camera.wrong = WrongTouch{tips.foci[worst], off_m};
  tips = rest;
  fit = others;
}

/// A fingertip in the top of assets/cube.glb.
const sensing::Capsule fingertip{{0, 6e-3, 0}, {0, 60e-3, 0}, 8e-3, 8e-3};

/// Gives the cameras' frames to the touches, and the session a tracker's.
class TouchedSource final : public sensing::DepthSource {
 public:
  TouchedSource(std::unique_ptr<sensing::DepthSource> cameras, CameraTouches& touches)
      : cameras_(std::move(cameras)), touches_(&touches) {
    touches_->begin(cameras_->cameras());
  }
  const std::vector<sensing::Camera>& cameras() const override { return none_; }

  bool next(sensing::FrameSet& out, double timeout_s) override {
    if (!cameras_->next(set_, timeout_s)) return false;
    out.frames.clear();
    out.capsules.clear();
    out.sequence = set_.sequence;
    out.tracked = !set_.frames.empty();
    if (!out.tracked) return true;
    out.time_s = set_.time_s;
    touches_->see(set_);
    if (touches_->focus()) out.capsules.push_back(fingertip);
    return true;
  }

 private:
  std::unique_ptr<sensing::DepthSource> cameras_;
  CameraTouches* touches_;
  std::vector<sensing::Camera> none_;
  sensing::FrameSet set_;
};

/// A simulated finger that goes to each focus, and finds it only nearly. While there is none, it is out of sight.
class RehearsedFinger {
 public:
  RehearsedFinger(const CameraTouches& touches, double off_m, std::uint64_t seed)
      : touches_(&touches), off_m_(off_m), seed_(seed) {}
  Transform operator()(double /*time_s*/) {
    const std::optional<Vec3> focus = touches_->focus();
    return glm::translate(Transform(1.0), focus ? *focus + off_at(*focus) : Vec3(0, 100, 0));
  }

 private:
  /// The same for one focus at all times.
  Vec3 off_at(const Vec3& focus) {
    if (focus != at_) {
      at_ = focus;
      Random random(seed_ * 1000 + ++foci_);
      const double each_m = off_m_ / std::sqrt(3.0);
      off_ = {each_m * random.normal(), each_m * random.normal(), each_m * random.normal()};
    }
    return off_;
  }

  const CameraTouches* touches_;
  double off_m_;
  std::uint64_t seed_, foci_ = 0;
  Vec3 at_{std::numeric_limits<double>::infinity()}, off_{0};
};

}  // namespace

TouchedCamera register_camera(const sensing::Camera& guess, std::span<const SeenTouch> touches,
                              const array::Layout& layout) {
  TouchedCamera camera{.name = guess.name, .T_world_camera = pose_to_begin(guess)};
  RigidFit fit;
  constexpr int iterations = 5;
  for (int i = 0; i < iterations; ++i) {
    Tips tips = tips_from(camera.T_world_camera, touches, layout);
    if (!tips.fix_a_pose()) {
      throw failure(fmt::format(
          "--by-touch: camera \"{}\" saw {} of {} touches{}, and {} that are wide apart are needed: nothing is saved; "
          "point with one finger to the array, where the camera sees its tip",
          guess.name, tips.seen.size(), touches.size(), tips.seen.size() < least_touches ? "" : ", nearly on a line",
          least_touches));
    }
    fit = tips.fit();
    camera.wrong.reset();
    leave_out_wrong(tips, fit, camera);
    camera.T_world_camera = fit.T_to_from;
  }
  if (!(fit.residual_m <= most_residual_m)) {
    throw failure(
        fmt::format("--by-touch: what camera \"{}\" saw does not fit the foci: {:.1f} mm off (rms), at most "
                    "{:.0f}: nothing is saved; touch each focus where it is felt",
                    guess.name, fit.residual_m * 1e3, most_residual_m * 1e3));
  }
  camera.residual_m = fit.residual_m;
  camera.seen = fit.off_m.size();
  const Transform between = glm::inverse(guess.T_world_camera) * camera.T_world_camera;
  camera.moved_m = glm::length(Vec3(between[3]));
  camera.turned_rad = std::acos(std::clamp((between[0][0] + between[1][1] + between[2][2] - 1) / 2, -1.0, 1.0));
  return camera;
}

session::SourceKind CameraTouches::source(std::vector<session::SourceKind> kinds) {
  return {.name = "joints",
          .help = "the cameras of --by-touch",
          .open = [this, kinds = std::move(kinds)](const std::string& argument, const session::SourceSetting& setting) {
            return std::make_unique<TouchedSource>(session::open_source(argument, with_builtin(kinds), setting), *this);
          }};
}

session::OwnMethod CameraTouches::method() {
  return [this](const touch::Touch&, const touch::Finger& finger, touch::Placement& out) {
    const std::lock_guard lock(mutex_);
    out.foci.assign(1, {.position = glm::vec3(place()), .points = finger.contact_count});
    out.complete = true;
    out.together = false;
  };
}

session::SourceKind CameraTouches::rehearsal(double off_m, bool noise) {
  return {.name = "synthetic",
          .help = "synthetic: a simulated finger that touches each focus",
          .open = [this, off_m, noise](const std::string&, const session::SourceSetting& setting) {
            sensing::SyntheticOptions options;
            options.noise = noise ? sensing::Noise::d415 : sensing::Noise::none;
            options.seed = setting.seed;
            options.paced = setting.paced;
            options.motion = RehearsedFinger(*this, off_m, setting.seed);
            options.skin_name = find_asset("finger.ply");
            return sensing::make_synthetic_source(setting.cameras, session::load_skin(options.skin_name),
                                                  setting.occluders, options);
          }};
}

Vec3 CameraTouches::place() const {
  return camera_foci[std::min(touches_.size(), camera_foci.size() - 1)] + offset_;
}

std::optional<Vec3> CameraTouches::focus() const {
  const std::lock_guard lock(mutex_);
  return learned_ ? std::optional(place()) : std::nullopt;
}

void CameraTouches::nudge(const Vec3& offset) {
  const std::lock_guard lock(mutex_);
  offset_ = offset;
}

void CameraTouches::begin(std::vector<sensing::Camera> cameras) {
  const std::lock_guard lock(mutex_);
  cameras_ = std::move(cameras);
  rays_.clear();
  learning_.clear();
  learned_frames_ = 0;
  learned_ = false;
  recent_.clear();
  for (sensing::Camera& camera : cameras_) {
    sensing::see_all(camera);
    rays_.push_back(sensing::make_rays(std::span(&camera, 1)));
    learning_.emplace_back(camera, background_frames);
  }
}

void CameraTouches::learn(const sensing::FrameSet& set) {
  for (std::size_t i = 0; i < cameras_.size(); ++i)
    learning_[i].add(set.frames[i].depth);
  if (++learned_frames_ < background_frames) return;
  for (std::size_t i = 0; i < cameras_.size(); ++i)
    cameras_[i].background = std::make_shared<sensing::Background>(learning_[i].finish().background);
  learning_.clear();
  learned_ = true;
}

void CameraTouches::see(const sensing::FrameSet& set) {
  std::vector<sensing::Camera> cameras;
  {
    const std::lock_guard lock(mutex_);
    if (!learned_) return learn(set);
    cameras = cameras_;
  }
  Hands hands{set.time_s, {}};
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const bool there = !set.frames[i].depth.empty();
    hands.by_camera.push_back(there ? sensing::hand_points(cameras[i], rays_[i], set.frames[i].depth)
                                    : std::vector<Vec3>());
  }
  const std::lock_guard lock(mutex_);
  if (std::exchange(on_its_way_, false)) return;
  if (!recent_.empty() && set.time_s <= recent_.back().time_s) recent_.clear();
  recent_.push_back(std::move(hands));
  while (recent_.front().time_s < set.time_s - mean_over_s)
    recent_.pop_front();
}

std::string CameraTouches::take(double time_s) {
  const std::lock_guard lock(mutex_);
  if (!learned_) return "wait: palpa looks at the empty place";
  if (touches_.size() == camera_foci.size()) return {};
  std::vector<SeenTouch> seen(cameras_.size(), {place(), {}});
  bool by_any = false, sways = false;
  const std::size_t every = std::max<std::size_t>(1, recent_.size() / most_frames);
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const Transform pose = pose_to_begin(cameras_[i]);
    const Vec3 way = glm::normalize(transform_direction(glm::inverse(pose), way_at(*layout_, place())));
    std::vector<Vec3> tips;
    for (std::size_t f = 0; f < recent_.size(); f += every) {
      const auto tip = sensing::find_fingertip(recent_[f].by_camera[i], way);
      if (recent_[f].time_s > time_s || !tip) continue;
      tips.push_back(tip->centre_m);
      seen[i].frames.push_back(recent_[f].by_camera[i]);
    }
    if (tips.size() < least_frames) {
      seen[i].frames.clear();
      continue;
    }
    by_any = true;
    for (const Vec3& tip : tips)
      sways |= glm::distance(tip, tips.front()) > most_sway_m;
  }
  if (sways) return "hold the fingertip still";
  if (!by_any) return "no camera sees a fingertip that points to the array";
  touches_.push_back(std::move(seen));
  offset_ = Vec3(0);
  recent_.clear();
  on_its_way_ = true;
  return {};
}

std::size_t CameraTouches::touched() const {
  const std::lock_guard lock(mutex_);
  return touches_.size();
}

std::string CameraTouches::line() const {
  const std::lock_guard lock(mutex_);
  if (!learned_) return "palpa looks at the empty place; keep hands away";
  if (touches_.size() == camera_foci.size()) return {};
  return fmt::format("focus {} of {}", touches_.size() + 1, camera_foci.size());
}

bool CameraTouches::complete() const {
  const std::lock_guard lock(mutex_);
  return touches_.size() == camera_foci.size();
}

std::vector<TouchedCamera> CameraTouches::result(std::span<const sensing::Camera> rig) const {
  const std::lock_guard lock(mutex_);
  std::vector<TouchedCamera> found;
  for (std::size_t i = 0; i < rig.size(); ++i) {
    std::vector<SeenTouch> seen;
    for (const std::vector<SeenTouch>& touch : touches_)
      seen.push_back(touch.at(i));
    found.push_back(register_camera(rig[i], seen, *layout_));
  }
  return found;
}

}  // namespace palpa::setup
