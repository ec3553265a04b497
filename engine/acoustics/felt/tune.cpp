#include "acoustics/felt/tune.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace palpa::acoustics {
namespace {

bool tunable(const Ring& ring) {
  return ring.foci >= 3 && ring.foci <= most_ring_foci && ring.perimeter_m > 0 && std::isfinite(ring.perimeter_m);
}

struct Best {
  Ring ring;
  Felt felt;
  bool any = false;
  void offer(const Ring& other, const Felt& other_felt) {
    // A rounding error is not enough: of equal candidates, the first stays.
    if (any && balance(other_felt) <= balance(felt) + 1e-9) return;
    ring = other;
    felt = other_felt;
    any = true;
  }
};

void offer_strides(const Harmonics& harmonics, Ring ring, double highest_hz, Best& best) {
  for (ring.stride = 1; 2 * ring.stride < ring.foci; ++ring.stride) {
    if (std::gcd(ring.stride, ring.foci) == 1) best.offer(ring, harmonics.felt(ring.stride, ring.dwell_s, highest_hz));
  }
}

bool worth_it(const Felt& before, const Felt& after, double gain) {
  return balance(after) > balance(before) + gain * before.vibration;
}

}  // namespace

Tuned tune(const Ring& ring, const TuneOptions& options, std::span<const Vec3> foci) {
  const FocusField* const field = foci.size() == ring.foci ? options.spectrum.field : nullptr;
  if (!tunable(ring)) return {ring, {}, {}, false, kind_of(field)};
  const double highest_hz = options.spectrum.highest_hz, fwhm_m = options.spectrum.fwhm_m;
  const std::optional<PathField> path = field ? std::optional<PathField>(std::in_place, *field, foci) : std::nullopt;
  const auto harmonics_of = [&](std::uint32_t count) {
    return path ? path->harmonics(count) : Harmonics(ring.perimeter_m, count, fwhm_m);
  };
  const Felt before = harmonics_of(ring.foci).felt(ring.stride, ring.dwell_s, highest_hz);
  constexpr double tenth_ms = 1e-4;
  const bool ranged = options.longest_dwell_s > 0;
  const auto last = static_cast<std::int64_t>(std::floor(options.longest_dwell_s / tenth_ms * (1 + 1e-12)));
  const auto first = static_cast<std::int64_t>(std::ceil(options.shortest_dwell_s / tenth_ms * (1 - 1e-12)));
  Best best;
  Ring candidate = ring;
  const std::uint32_t most = std::min(most_ring_foci, std::max(options.most_foci, ring.foci));
  for (candidate.foci = ring.foci; candidate.foci <= most; ++candidate.foci) {
    const Harmonics harmonics = harmonics_of(candidate.foci);
    candidate.dwell_s = ring.dwell_s;
    if (!ranged) offer_strides(harmonics, candidate, highest_hz, best);
    for (std::int64_t tenths = last; ranged && tenths >= std::max<std::int64_t>(first, 1); --tenths) {
      candidate.dwell_s = static_cast<double>(tenths) / 10000;
      offer_strides(harmonics, candidate, highest_hz, best);
    }
  }
  const bool within = !ranged || (ring.dwell_s >= options.shortest_dwell_s && ring.dwell_s <= options.longest_dwell_s);
  if (!best.any || (within && !worth_it(before, best.felt, options.gain)))
    return {ring, before, before, false, kind_of(field)};
  return {best.ring, before, best.felt, true, kind_of(field)};
}

const StrideTuner::Known* StrideTuner::find(std::uint32_t id) const {
  for (const Known& finger : known_) {
    if (finger.used && finger.id == id) return &finger;
  }
  return nullptr;
}
StrideTuner::Known* StrideTuner::find(std::uint32_t id) {
  return const_cast<Known*>(std::as_const(*this).find(id));
}

StrideTuner::Known& StrideTuner::known(std::uint32_t id) {
  if (Known* finger = find(id)) return *finger;
  Known* oldest = known_.data();
  for (Known& finger : known_) {
    const bool freer = !finger.used || finger.seen < oldest->seen;
    if (oldest->used && freer) oldest = &finger;
  }
  *oldest = {};
  return *oldest;
}

std::uint32_t StrideTuner::stride_for(std::uint32_t id, const Ring& ring, double time_s) {
  if (!tunable(ring)) return ring.stride;
  Known& finger = known(id);
  const bool fresh = !finger.used || finger.foci != ring.foci;
  if (fresh) finger = {.used = true, .id = id, .foci = ring.foci, .stride = ring.stride, .decides = true};
  finger.seen = ++calls_;
  if (!finger.decides && std::abs(time_s - finger.chosen_s) < rest_s) return finger.stride;
  if (finger.decides) finger.stride = ring.stride;
  const bool learned = finger.learned.foci() == ring.foci;
  const Harmonics harmonics = learned ? finger.learned : Harmonics(ring.perimeter_m, ring.foci, options_.fwhm_m);
  Best best;
  offer_strides(harmonics, ring, options_.highest_hz, best);
  const Felt now = harmonics.felt(finger.stride, ring.dwell_s, options_.highest_hz);
  const bool change = worth_it(now, best.felt, finger.decides ? TuneOptions().gain : gain);
  if (finger.decides || change) finger.chosen_s = time_s;
  if (change) finger.stride = best.ring.stride;
  finger.decides = false;
  return finger.stride;
}

void StrideTuner::learn(std::uint32_t id, const Harmonics& harmonics, double time_s) {
  Known* const finger = find(id);
  if (!finger || harmonics.foci() != finger->foci) return;
  finger->decides = finger->decides || finger->learned.foci() != harmonics.foci();
  finger->learned = harmonics;
  finger->learned_s = time_s;
}

bool StrideTuner::wants(std::uint32_t id, double time_s) const {
  const Known* const finger = find(id);
  return finger && (finger->learned.foci() != finger->foci || std::abs(time_s - finger->learned_s) >= rest_s);
}

}  // namespace palpa::acoustics
