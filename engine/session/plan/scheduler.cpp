#include "session/plan/scheduler.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "acoustics/field/asked_field.hpp"
#include "geometry/haptics.hpp"
#include "session/plan/tuning_thread.hpp"
#include "session/plan/voice.hpp"
#include "touch/fingers/nearest_filled.hpp"

namespace palpa::session {

static_assert(acoustics::StrideTuner::most_fingers >= touch::max_fingers);
static_assert(acoustics::most_ring_foci >= touch::max_foci);

Scheduler::Scheduler(const std::string& scene, std::span<const geometry::Solid> solids,
                     const touch::FingerOptions& touch, const ScheduleOptions& options,
                     const acoustics::FocusField* field, double hold_s)
    : solids_(resolve_haptics(scene, solids, touch, options.voice)),
      foci_(touch.foci),
      options_(options),
      slot_s_(slot_length(solids_, options.voice)),
      feel_(solids, solids_, {slot_s_, options.steady}, hold_s) {
  acoustics::SpectrumOptions& spectrum = options_.tuning.spectrum;
  spectrum.field = field;
  spectrum.fwhm_m = options.spot_m.value_or(spectrum.fwhm_m);
  strides_ = acoustics::StrideTuner(spectrum);
  fingers_.resize(touch::max_fingers);
  for (ScheduledFinger& finger : fingers_)
    finger.placement.foci.reserve(touch::max_foci);
}

bool Scheduler::needs_pressures() const {
  return std::ranges::any_of(solids_, [](const SolidHaptics& solid) { return solid.voice.pressure_pa.has_value(); });
}

Scheduler::~Scheduler() = default;
Scheduler::Scheduler(Scheduler&&) noexcept = default;
Scheduler& Scheduler::operator=(Scheduler&&) noexcept = default;

void Scheduler::tune_beside(const acoustics::ArrayField* field) {
  beside_ = field && options_.tune == Tune::stride ? std::make_unique<TuningThread>(*field) : nullptr;
}

void Scheduler::make(const touch::Touch& touch, double time_s, array::Schedule& schedule, const Following& following) {
  schedule.clear();
  schedule.slot_s = slot_s_;
  schedule.time_s = time_s;
  count_ = touch.finger_count;
  if (beside_) beside_->begin(strides_);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    ScheduledFinger& out = fingers_[f];
    out.perimeter_m = 0;
    out.tuned.reset();
    if (options_.own_method) {
      options_.own_method(touch, finger, out.placement);
    } else {
      touch::place_foci(touch, finger, options_.method, out.placement);
    }
    array::VoiceOptions options = solids_[finger.solid].voice;
    // The usual stride is that of the usual number of foci. An own method may have any other.
    if (options_.own_method && !options_.voice.stride) options.stride.reset();
    if (foci_part_ > 1 && !out.placement.still() && !out.placement.together) thin(out.placement, options);
    array::Voice& voice = schedule.add_voice();
    make_voice(out.placement, finger.id, finger.solid, options, voice);
    if (!out.placement.still()) {
      out.perimeter_m = touch::perimeter_of(out.placement);
      if (options_.tune != Tune::nothing) {
        tune(touch, finger, time_s, voice.foci, options, out);
        make_voice(out.placement, finger.id, finger.solid, options, voice);
      }
    }
    if (aim_ != Vec3(0)) {
      for (Vec3& focus : voice.foci)
        focus += aim_;
    }
    schedule.slot_s = std::min(schedule.slot_s, options.dwell_s);
  }
  feel_.shape(touch, time_s, options_.steady ? Following() : following, aim_, schedule);
  if (beside_) beside_->end();
}

void Scheduler::thin(touch::Placement& placement, array::VoiceOptions& voice) const {
  const auto count = static_cast<std::uint32_t>(placement.foci.size());
  const std::uint32_t left = std::max(std::min(count, fewest_foci), count / foci_part_);
  if (left == count) return;
  // The same sectors as in make_voice. If no sector has a position, each stays without one.
  const auto placed = [&](std::uint32_t sector) {
    const std::uint32_t near = touch::nearest_filled(sector, count, [&](std::uint32_t i) { return placement.has(i); });
    return near == count ? sector : near;
  };
  std::array<touch::Focus, touch::max_foci> chosen;
  for (std::uint32_t f = 0; f < left; ++f)
    chosen[f] = placement.foci[placed(f * count / left)];
  std::copy_n(chosen.begin(), left, placement.foci.begin());
  placement.foci.resize(left);
  // The requested stride may share a divisor with the remaining number of foci.
  if (voice.stride && std::gcd(*voice.stride, left) != 1) voice.stride = geometry::default_stride(left);
}

void Scheduler::tune(const touch::Touch& touch, const touch::Finger& finger, double time_s, std::span<const Vec3> foci,
                     array::VoiceOptions& voice, ScheduledFinger& out) {
  const auto count = static_cast<std::uint32_t>(foci.size());
  const acoustics::Ring ring{out.perimeter_m, count, voice.stride.value_or(geometry::default_stride(count)),
                             voice.dwell_s};
  if (options_.tune == Tune::stride) {
    voice.stride = strides_.stride_for(finger.id, ring, time_s);
    if (beside_) beside_->look_at(finger.id, foci, voice.pressure_pa.has_value(), time_s, strides_);
    return;
  }
  acoustics::TuneOptions tuning = options_.tuning;
  std::optional<acoustics::AskedField> asked;
  if (voice.pressure_pa && kind_of(tuning.spectrum.field) == acoustics::FocusKind::array)
    tuning.spectrum.field = &asked.emplace(*tuning.spectrum.field);
  const acoustics::Tuned& tuned = out.tuned.emplace(acoustics::tune(ring, tuning, foci));
  voice.stride = tuned.ring.stride;
  voice.dwell_s = tuned.ring.dwell_s;
  if (tuned.ring.foci == count) return;
  touch::MethodOptions method = options_.method;
  method.foci = tuned.ring.foci;
  touch::place_foci(touch, finger, method, out.placement);
  out.perimeter_m = out.tuned->ring.perimeter_m = touch::perimeter_of(out.placement);
}

array::Voice Scheduler::common_voice() const {
  touch::Placement placement;
  placement.complete = true;
  const touch::Method method = options_.method.method;
  placement.together = touch::sounds_together(method);
  placement.foci.resize(touch::stands_still(method) && !placement.together ? 1 : foci_);
  array::Voice voice;
  make_voice(placement, 0, 0, options_.voice, voice);
  return voice;
}

}  // namespace palpa::session
