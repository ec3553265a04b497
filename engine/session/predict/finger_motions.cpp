#include "session/predict/finger_motions.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include "session/predict/second_search.hpp"

namespace palpa::session {
namespace {

/// Noise of a finger's place from frame to frame, with a D415's images.
constexpr double place_noise_m = 0.1e-3;
constexpr double most_growth = 2.5;
/// The skin around the contacts whose steps are followed.
constexpr double skin_reach_m = 12e-3;

}  // namespace

FingerMotions::FingerMotions() {
  const Known fresh{.filter = MotionFilter(place_noise_m)};
  known_.resize(touch::max_fingers, fresh);
  before_.resize(touch::max_fingers, fresh);
}

void FingerMotions::see(const touch::Touch& touch, double time_s, const FramePair* frames) {
  std::swap(known_, before_);
  const auto before = std::span(before_).first(count_);
  count_ = touch.finger_count;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    Known& known = known_[f];
    const auto old = std::ranges::find(before, finger.id, &Known::id);
    if (old != before.end()) {
      known = *old;
    } else {
      known.filter.restart();
      known.id = finger.id;
      known.time_s = time_s;
      known.spread_m2 = 0;
      known.centroid = known.place = Vec3(finger.section.centroid);
    }
    go_on(known, finger, time_s, old != before.end() ? frames : nullptr, frames == nullptr);
  }
}

void FingerMotions::go_on(Known& known, const touch::Finger& finger, double time_s, const FramePair* frames,
                          bool tracked) {
  const Vec3 centroid(finger.section.centroid);
  const double spread = finger.section.eigenvalues[0];
  const bool other_size = spread > most_growth * known.spread_m2 || most_growth * spread < known.spread_m2;
  known.box = contact_box(finger);
  Vec3 step = centroid - known.centroid;
  if (frames) {
    const double dt = time_s - known.time_s;
    const Vec3 expected = dt > 0 && dt <= MotionFilter::longest_pause_s ? known.filter.velocity() * dt : Vec3(0);
    const Box skin{known.box.low - skin_reach_m, known.box.high + skin_reach_m};
    const SkinStep found = find_skin_step(frames->view, frames->now, frames->before, skin, expected, step, scratch_);
    if (found.samples >= least_skin_samples) {
      step = found.way;
    } else if (other_size) {
      known.filter.restart();
    }
  } else if (other_size) {
    known.filter.restart();
  }
  known.place += step;
  known.filter.see(time_s, known.place, tracked);
  known.centroid = centroid;
  known.spread_m2 = spread;
  known.time_s = time_s;
}

}  // namespace palpa::session
