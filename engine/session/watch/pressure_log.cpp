#include "session/watch/pressure_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/log.hpp"

namespace palpa::session {

std::optional<std::string> unreached(const array::Schedule& schedule, std::span<const std::string> solid_names,
                                     const char* why) {
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const array::Voice& voice = schedule.voices[v];
    const double asked = voice.asked_pa();
    if (!voice.reached_pa || is_reached(asked, *voice.reached_pa)) continue;
    const int decimals = asked < 100 ? 2 : 0;
    return fmt::format("finger {} on {} has {:.{}f} Pa of the {:.{}f} Pa that are asked for: {}{}", voice.id,
                       voice.solid < solid_names.size() ? solid_names[voice.solid] : "", *voice.reached_pa, decimals,
                       asked, decimals, why, schedule.voice_count > 1 ? " while other fingers sound" : "");
  }
  return std::nullopt;
}

bool beyond_linear(const array::Schedule& schedule) {
  return std::any_of(schedule.voices.begin(), schedule.voices.begin() + schedule.voice_count,
                     [](const auto& voice) { return voice.reached_pa.value_or(0) > array::linear_pressure_pa; });
}

void PressureLog::planned(const array::Schedule& schedule, const array::Schedule* played) {
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const array::Voice& voice = (played ? *played : schedule).voices[v];
    if (!voice.reached_pa) continue;
    auto finger = std::ranges::find(fingers_, voice.id, &FingerPressure::id);
    if (finger == fingers_.end()) {
      if (fingers_.size() == most) continue;
      finger = fingers_.insert(finger, {.id = voice.id, .solid = voice.solid});
    }
    const double reached = *voice.reached_pa;
    finger->asked_pa = voice.asked_pa();
    finger->least_pa = finger->frames == 0 ? reached : std::min(finger->least_pa, reached);
    finger->most_pa = std::max(finger->most_pa, reached);
    finger->sum_pa += reached;
    ++finger->frames;
  }
  if (warned_) return;
  std::optional<std::string> fault = unreached(schedule, solid_names_);
  if (played) {
    fault = fault
                ? unreached(*played, solid_names_)
                : unreached(*played, solid_names_, "with the steps of its boards' amplitudes, more would be too much");
  }
  warned_ = fault.has_value();
  if (fault) log::warning(*fault + "; this warning comes once, and the stats have every finger");
}

void write_pressures(std::span<const FingerPressure> fingers, std::span<const std::string> solid_names,
                     JsonWriter& json) {
  if (fingers.empty()) return;
  constexpr int digits = 6;
  json.key("fingers").begin_array();
  for (const FingerPressure& finger : fingers) {
    json.begin_object().member("id", finger.id).member("solid", solid_names[finger.solid]);
    json.member("frames", finger.frames).member("asked_pa", finger.asked_pa);
    json.key("pressure_pa").begin_object();
    json.key("least").rounded(finger.least_pa, digits);
    json.key("mean").rounded(finger.sum_pa / static_cast<double>(finger.frames), digits);
    json.key("most").rounded(finger.most_pa, digits);
    json.end_object().end_object();
  }
  json.end_array();
}

}  // namespace palpa::session
