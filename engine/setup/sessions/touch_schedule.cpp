#include "setup/sessions/touch_schedule.hpp"

namespace palpa::setup {

session::ScheduleOptions schedule_options(const TouchOptions& options) {
  session::ScheduleOptions schedule{.method = options.method,
                                    .voice = {.stride = options.stride,
                                              .dwell_s = options.dwell_s,
                                              .modulation_hz = options.modulation_hz,
                                              .modulation = options.modulation},
                                    .tune = options.tune ? session::Tune::stride : session::Tune::nothing,
                                    .spot_m = options.spot_m,
                                    .steady = options.steady_gains};
  schedule.method.equal_arc = options.parameters.spacing == touch::Spacing::arc;
  return schedule;
}

session::ScheduleOptions schedule_options(const TouchOptions& options, const FeltOptions& felt) {
  session::ScheduleOptions schedule = schedule_options(options);
  if (options.tune) schedule.tune = session::Tune::all;
  schedule.tuning.shortest_dwell_s = felt.shortest_dwell_s.value_or(0);
  schedule.tuning.longest_dwell_s = felt.longest_dwell_s.value_or(0);
  return schedule;
}

std::vector<acoustics::Spectrum> spectra_of(const session::Session& session) {
  acoustics::SpectrumOptions options;
  options.field = session.field();
  options.fwhm_m = session.setting().schedule.spot_m.value_or(options.fwhm_m);
  return spectra_of(session.schedule(), options);
}

std::vector<acoustics::Spectrum> spectra_of(const array::Schedule& schedule,
                                            const acoustics::SpectrumOptions& options) {
  std::vector<acoustics::Spectrum> spectra;
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const array::Voice& voice = schedule.voices[v];
    // A dwell that is not a whole number of slots is kept only on average. The requested dwell is shown.
    const bool moves = voice.order.size() > voice.foci_per_slot;
    spectra.push_back(acoustics::spectrum_of(voice, moves ? voice.dwell_s : schedule.slot_s, options));
  }
  return spectra;
}

}  // namespace palpa::setup
