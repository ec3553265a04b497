#include "session/predict/predictor.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

namespace palpa::session {
namespace {

/// A finger may move by this much until its next image is kept.
constexpr double image_margin_m = 10e-3;

}  // namespace

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
