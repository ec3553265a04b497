#include "setup/touch_schedule.hpp"

#include <algorithm>

#include "session/overrides.hpp"
#include "session/voice.hpp"

namespace palpa::setup {
namespace {

/// Chooses foci, stride and dwell by the perimeter; more foci are placed anew.
void tune_finger(const touch::Touch& touch, const touch::Finger& finger, const TouchOptions& options,
                 const FeltOptions& felt, FingerSchedule& out) {
  acoustics::TuneOptions tune;
  tune.spectrum.fwhm_m = felt.spot_m.value_or(tune.spectrum.fwhm_m);
  tune.shortest_dwell_s = felt.shortest_dwell_s.value_or(0);
  tune.longest_dwell_s = felt.longest_dwell_s.value_or(0);
  const auto foci = static_cast<std::uint32_t>(out.placement.foci.size());
  out.tuned = acoustics::tune({out.perimeter_m, foci, out.voice.stride, out.voice.dwell_s}, tune);
  out.voice.stride = out.tuned->ring.stride;
  out.voice.dwell_s = out.tuned->ring.dwell_s;
  if (out.tuned->ring.foci == foci) return;
  touch::MethodOptions method = method_options(options);
  method.foci = out.tuned->ring.foci;
  touch::place_foci(touch, finger, method, out.placement);
}

}  // namespace

std::vector<FingerSchedule> schedule_fingers(const touch::Touch& touch, std::span<const geometry::Solid> solids,
                                             const TouchOptions& options, const FeltOptions& felt) {
  std::vector<FingerSchedule> fingers(touch.finger_count);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    FingerSchedule& finger = fingers[f];
    touch::place_foci(touch, touch.fingers[f], method_options(options), finger.placement);
    finger.voice = session::voice_on(solids[touch.fingers[f].solid], voice_options(options));
    if (finger.placement.still()) continue;
    finger.perimeter_m = touch::perimeter_of(finger.placement);
    if (options.tune) tune_finger(touch, touch.fingers[f], options, felt, finger);
  }
  return fingers;
}

array::Schedule make_schedule(const touch::Touch& touch, std::span<const geometry::Solid> solids,
                              const std::vector<FingerSchedule>& fingers, const TouchOptions& options) {
  array::Schedule schedule;
  schedule.slot_s = session::slot_length(solids, voice_options(options));
  for (std::uint32_t f = 0; f < fingers.size(); ++f) {
    session::make_voice(fingers[f].placement, f, touch.fingers[f].solid, fingers[f].voice, schedule.add_voice());
    schedule.slot_s = std::min(schedule.slot_s, fingers[f].voice.dwell_s);
  }
  return schedule;
}

std::vector<acoustics::Spectrum> spectra_of(const array::Schedule& schedule, const FeltOptions& felt) {
  acoustics::SpectrumOptions options;
  options.fwhm_m = felt.spot_m.value_or(options.fwhm_m);
  std::vector<acoustics::Spectrum> spectra;
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const array::Voice& voice = schedule.voices[v];
    // A dwell that is no whole number of slots is one on average: what is shown is the dwell as it was asked for.
    const bool moves = voice.order.size() > voice.foci_per_slot;
    spectra.push_back(acoustics::spectrum_of(voice, moves ? voice.dwell_s : schedule.slot_s, options));
  }
  return spectra;
}

}  // namespace palpa::setup
