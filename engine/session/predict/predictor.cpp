#include "session/predict/predictor.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

namespace palpa::session {
namespace {

/// Noise of a finger's place from frame to frame, with a D415's images.
constexpr double place_noise_m = 0.1e-3;
constexpr double most_growth = 2.5;
/// The skin around the contacts whose steps are followed.
constexpr double skin_reach_m = 12e-3;

/// A finger may move by this much until its next image is kept.
constexpr double image_margin_m = 10e-3;

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

Ahead ahead_of(const std::optional<FirstSlot>& first, double latency_s, std::uint32_t cycle, double slot_s) {
  const double to_middle_s = 0.5 * (cycle - 1) * slot_s;
  const double middle_s = latency_s + to_middle_s;
  Ahead ahead;
  ahead.foci_s = std::clamp(middle_s, 0.0, most_ahead_s);
  ahead.clamped = middle_s + to_middle_s > most_ahead_s;
  if (!first) return ahead;
  ahead.advance = {.first_slot = first->slot,
                   .cycle = cycle,
                   .cycles = 2,
                   .first_s = std::clamp(latency_s, 0.0, most_ahead_s) - ahead.foci_s,
                   .most_s = most_ahead_s - ahead.foci_s};
  return ahead;
}

Predictor::Predictor(const PredictorSetting& setting)
    : setting_(setting), search_(setting.view, setting.solids, setting.parameters), before_(setting.view) {
  boxes_.reserve(touch::max_fingers);
}

void Predictor::keep(std::span<const sensing::DepthFrame> images, KeptFrames& kept) {
  boxes_.clear();
  const double margin_m = search_.reach_m() + image_margin_m;
  for (std::uint32_t f = 0; f < motions_.count(); ++f)
    boxes_.push_back({motions_.box(f).low - margin_m, motions_.box(f).high + margin_m});
  kept.keep(setting_.view, images, boxes_);
}

const touch::Touch& Predictor::see(const touch::Touch& seen, double time_s, const std::optional<FirstSlot>& first,
                                   KeptFrames& kept) {
  const bool images = kept.any();
  const FramePair pair{setting_.view, kept, before_};
  motions_.see(seen, time_s, images && before_.any() ? &pair : nullptr);
  made_.reset();
  moves_ = false;
  const std::optional<double> latency_s = setting_.options.latency_s ? setting_.options.latency_s
                                          : first                    ? first->ahead_s
                                                                     : std::nullopt;
  if (latency_s && seen.finger_count > 0) {
    times_ = ahead_of(first, *latency_s, setting_.cycle, setting_.slot_s);
    made_ = Prediction{.latency_s = *latency_s, .clamped = times_.clamped};
    for (std::uint32_t f = 0; f < seen.finger_count; ++f) {
      velocity_[f] = motions_.velocity(f);
      if (glm::length(velocity_[f]) * most_ahead_s < least_way_m) velocity_[f] = Vec3(0);
      moves_ = moves_ || velocity_[f] != Vec3(0);
    }
  }
  if (moves_) {
    ahead_.contacts.clear();
    ahead_.deep.clear();
    ahead_.finger_count = 0;
    ahead_.cluster_count = seen.cluster_count;
    for (std::uint32_t f = 0; f < seen.finger_count; ++f) {
      const std::uint32_t place = ahead_.finger_count;
      const Vec3 way = velocity_[f] * times_.foci_s;
      made_->distance_m = std::max(made_->distance_m, glm::length(way));
      const bool still = velocity_[f] == Vec3(0);
      const bool touches =
          !still && images ? search_.move(seen, f, way, kept, ahead_) : (add_moved(seen, f, way, ahead_), true);
      if (touches) velocity_[place] = velocity_[f];
    }
  }
  std::swap(before_, kept);
  return moves_ ? ahead_ : seen;
}

std::optional<Prediction> Predictor::advance(array::Schedule& schedule) const {
  if (!moves_) return made_;
  schedule.advance = times_.advance;
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v)
    schedule.voices[v].velocity = velocity_[v];
  return made_;
}

}  // namespace palpa::session
