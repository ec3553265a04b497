#include "acoustics/tune.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace palpa::acoustics {
namespace {

constexpr double pi = std::numbers::pi;

/// What the strides and dwells of a ring have in common: the power of its angular harmonics, a mean over skin points.
class Harmonics {
 public:
  /// As spectrum_of(Ring) has it, without its allocations.
  Harmonics(double perimeter_m, std::uint32_t foci, double fwhm_m) : foci_(foci) {
    constexpr int points = 8;
    const auto count = static_cast<double>(foci);
    std::array<std::complex<double>, most_ring_foci> turns;
    for (std::uint32_t k = 0; k < foci; ++k)
      turns[k] = std::polar(1.0, -2 * pi * k / count);
    const int more = std::min(1000, static_cast<int>(std::ceil(3 * fwhm_m / perimeter_m)) + 1);
    std::array<double, most_ring_foci> pressures{};
    double mean = 0;
    for (int point = 0; point < points; ++point) {
      for (std::uint32_t k = 0; k < foci; ++k) {
        pressures[k] = 0;
        for (int turn = -more; turn <= more; ++turn) {
          const double x = ((point / double{points} - k) / count + turn) * perimeter_m / fwhm_m;
          pressures[k] += std::exp(-4 * std::numbers::ln2 * x * x);
        }
      }
      for (std::uint32_t n = 0; n < foci; ++n) {
        std::complex<double> c = 0;
        for (std::uint32_t k = 0; k < foci; ++k)
          c += pressures[k] * turns[n * k % foci];
        if (n == 0) mean += c.real() / count / points;
        power_[n] += std::norm(c / count) / points;
      }
    }
    for (std::uint32_t n = 1; n < foci; ++n)
      variance_ += power_[n];
    if (!(variance_ > 1e-12 * mean * mean)) variance_ = 0;
  }

  double share(std::uint32_t stride, double dwell_s, double highest_hz) const {
    if (variance_ == 0) return 0;
    const auto count = static_cast<double>(foci_);
    const auto lines = static_cast<std::uint64_t>(std::max(0.0, highest_hz * count * dwell_s * (1 + 1e-12)));
    // m = stride n: counting n up by the stride's inverse goes through the lines in order.
    std::uint32_t inverse = 1;
    while (std::uint64_t{inverse} * stride % foci_ != 1 % foci_)
      ++inverse;
    std::uint32_t n = 0;
    double felt = 0;
    for (std::uint64_t m = 1; m <= lines; ++m) {
      n = (n + inverse) % foci_;
      const double x = static_cast<double>(m) / count;
      const double hold = std::sin(pi * x) / (pi * x), weight = skin_sensitivity(x / dwell_s);
      felt += 2 * power_[n] * hold * hold * weight * weight;
    }
    return felt / variance_;
  }

 private:
  std::uint32_t foci_;
  std::array<double, most_ring_foci> power_{};
  double variance_ = 0;
};

bool tunable(const Ring& ring) {
  return ring.foci >= 3 && ring.foci <= most_ring_foci && ring.perimeter_m > 0 && std::isfinite(ring.perimeter_m);
}

struct Best {
  Ring ring;
  double share = -1;
  void offer(const Ring& other, double other_share) {
    // Not by a rounding error: of equals the first stays.
    if (other_share > share * (1 + 1e-9)) {
      ring = other;
      share = other_share;
    }
  }
};

void offer_strides(const Harmonics& harmonics, Ring ring, double highest_hz, Best& best) {
  for (ring.stride = 1; 2 * ring.stride < ring.foci; ++ring.stride) {
    if (std::gcd(ring.stride, ring.foci) == 1) best.offer(ring, harmonics.share(ring.stride, ring.dwell_s, highest_hz));
  }
}

}  // namespace

Tuned tune(const Ring& ring, const TuneOptions& options) {
  if (!tunable(ring)) return {ring, 0, 0, false};
  const double highest_hz = options.spectrum.highest_hz, fwhm_m = options.spectrum.fwhm_m;
  const double before = Harmonics(ring.perimeter_m, ring.foci, fwhm_m).share(ring.stride, ring.dwell_s, highest_hz);
  constexpr double tenth_ms = 1e-4;
  const bool ranged = options.longest_dwell_s > 0;
  const auto last = static_cast<std::int64_t>(std::floor(options.longest_dwell_s / tenth_ms * (1 + 1e-12)));
  const auto first = static_cast<std::int64_t>(std::ceil(options.shortest_dwell_s / tenth_ms * (1 - 1e-12)));
  Best best;
  Ring candidate = ring;
  const std::uint32_t most = std::min(most_ring_foci, std::max(options.most_foci, ring.foci));
  for (candidate.foci = ring.foci; candidate.foci <= most; ++candidate.foci) {
    const Harmonics harmonics(ring.perimeter_m, candidate.foci, fwhm_m);
    candidate.dwell_s = ring.dwell_s;
    if (!ranged) offer_strides(harmonics, candidate, highest_hz, best);
    for (std::int64_t tenths = last; ranged && tenths >= std::max<std::int64_t>(first, 1); --tenths) {
      candidate.dwell_s = static_cast<double>(tenths) / 10000;
      offer_strides(harmonics, candidate, highest_hz, best);
    }
  }
  const bool within = !ranged || (ring.dwell_s >= options.shortest_dwell_s && ring.dwell_s <= options.longest_dwell_s);
  if (best.share < 0 || (within && best.share <= before * (1 + options.gain))) return {ring, before, before, false};
  return {best.ring, before, best.share, true};
}

StrideTuner::Known& StrideTuner::known(std::uint32_t id) {
  Known* oldest = known_.data();
  for (Known& finger : known_) {
    if (finger.used && finger.id == id) return finger;
    const bool freer = !finger.used || finger.seen_s < oldest->seen_s;
    if (oldest->used && freer) oldest = &finger;
  }
  *oldest = {};
  return *oldest;
}

std::uint32_t StrideTuner::stride_for(std::uint32_t id, const Ring& ring, double time_s) {
  if (!tunable(ring)) return ring.stride;
  Known& finger = known(id);
  const bool fresh = !finger.used || finger.foci != ring.foci;
  const SpectrumOptions options;
  const double highest_hz = options.highest_hz;
  const bool resting = !fresh && std::abs(time_s - finger.chosen_s) < rest_s;
  finger.seen_s = time_s;
  if (resting) return finger.stride;
  const Harmonics harmonics(ring.perimeter_m, ring.foci, options.fwhm_m);
  const std::uint32_t now = fresh ? ring.stride : finger.stride;
  Best best;
  offer_strides(harmonics, ring, highest_hz, best);
  const double needed = harmonics.share(now, ring.dwell_s, highest_hz) * (1 + (fresh ? TuneOptions().gain : gain));
  const bool change = best.share > needed;
  if (fresh || change) finger.chosen_s = time_s;
  finger = {true, id, ring.foci, change ? best.ring.stride : now, finger.chosen_s, time_s};
  return finger.stride;
}

}  // namespace palpa::acoustics
