#include "acoustics/felt/harmonics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

/// e^{-2 pi i k / count} for k = 0 .. count - 1.
std::vector<Complex> turns_of(std::size_t count) {
  std::vector<Complex> turns;
  for (std::size_t k = 0; k < count; ++k)
    turns.push_back(std::polar(1.0, -2 * pi * static_cast<double>(k) / static_cast<double>(count)));
  return turns;
}

}  // namespace

Harmonics::Harmonics(double perimeter_m, std::uint32_t foci, double fwhm_m) : foci_(foci) {
  assert(foci >= 1 && foci <= most_ring_foci);
  constexpr int points = 8;
  const auto count = static_cast<double>(foci);
  std::array<Complex, most_ring_foci> turns;
  for (std::uint32_t k = 0; k < foci; ++k)
    turns[k] = std::polar(1.0, -2 * pi * k / count);
  const int more = std::min(1000, static_cast<int>(std::ceil(3 * fwhm_m / perimeter_m)) + 1);
  std::array<double, most_ring_foci> pressures{};
  for (int point = 0; point < points; ++point) {
    for (std::uint32_t k = 0; k < foci; ++k) {
      pressures[k] = 0;
      for (int turn = -more; turn <= more; ++turn) {
        const double x = ((point / double{points} - k) / count + turn) * perimeter_m / fwhm_m;
        pressures[k] += std::exp(-4 * std::numbers::ln2 * x * x);
      }
    }
    for (std::uint32_t n = 0; n < foci; ++n) {
      Complex c = 0;
      for (std::uint32_t k = 0; k < foci; ++k)
        c += pressures[k] * turns[n * k % foci];
      power_[n] += std::norm(c / count) / points;
    }
  }
  set_variance();
}

Harmonics::Harmonics(std::span<const double> powers) : foci_(static_cast<std::uint32_t>(powers.size())) {
  assert(powers.size() <= most_ring_foci);
  std::ranges::copy(powers, power_.begin());
  set_variance();
}

void Harmonics::set_variance() {
  for (std::uint32_t n = 1; n < foci_; ++n)
    variance_ += power_[n];
  // Only rounding: nothing changes.
  if (!(variance_ > 1e-12 * power_[0])) variance_ = 0;
}

Felt Harmonics::felt(std::uint32_t stride, double dwell_s, double highest_hz) const {
  Felt felt;
  if (variance_ == 0) return felt;
  const auto count = static_cast<double>(foci_);
  const auto lines = static_cast<std::uint64_t>(std::max(0.0, highest_hz * count * dwell_s * (1 + 1e-12)));
  // m = stride n: incrementing n by the stride's inverse visits the lines in order.
  std::uint32_t inverse = 1;
  while (std::uint64_t{inverse} * stride % foci_ != 1 % foci_)
    ++inverse;
  std::uint32_t n = 0;
  for (std::uint64_t m = 1; m <= lines; ++m) {
    n = (n + inverse) % foci_;
    const double x = static_cast<double>(m) / count;
    const double hold = std::sin(pi * x) / (pi * x), hz = x / dwell_s;
    const double energy = 2 * power_[n] * hold * hold / variance_;
    felt.vibration += energy * vibration_sensitivity(hz) * vibration_sensitivity(hz);
    felt.flutter += energy * flutter_sensitivity(hz) * flutter_sensitivity(hz);
  }
  return felt;
}

PathField::PathField(const FocusField& field, std::span<const Vec3> foci, const std::atomic<bool>* give_up) {
  const std::size_t per_side = steps_per_side(foci, field.step_m());
  const std::vector<Vec3> path = path_through(foci, per_side);
  std::vector<double> pressures;
  if (!field.felt(path, 1, pressures, give_up)) return;
  const std::size_t places = path.size();
  const std::vector<Complex> turns = turns_of(places);
  for (std::size_t place = 0; place < places; ++place) {
    if (give_up && *give_up) return;
    const std::size_t side = place / per_side;
    // A tiny length as in spectrum_of.
    weights_.push_back(glm::distance(foci[side], foci[(side + 1) % foci.size()]) + 1e-12);
    for (std::size_t b = 0; b < places; ++b) {
      Complex sum = 0;
      for (std::size_t focus = 0; focus < places; ++focus)
        sum += pressures[focus * places + place] * turns[b * focus % places];
      terms_.push_back(sum / static_cast<double>(places));
    }
  }
  places_ = places;  // all places are valid
}

Harmonics PathField::harmonics(std::uint32_t foci) const {
  assert(foci >= 1 && foci <= most_ring_foci);
  std::array<double, most_ring_foci> powers{};
  std::array<Complex, most_ring_foci> folded;
  for (std::size_t place = 0; place < places_; ++place) {
    folded.fill(0);
    for (std::size_t b = 0; b < places_; ++b) {
      // The lowest of the frequencies that the grid cannot distinguish: b, or b - places.
      const std::size_t back = (places_ - b) % foci;
      const std::size_t n = 2 * b <= places_ ? b % foci : (foci - back) % foci;
      folded[n] += terms_[place * places_ + b];
    }
    for (std::uint32_t n = 0; n < foci; ++n)
      powers[n] += weights_[place] * std::norm(folded[n]);
  }
  return Harmonics(std::span(powers).first(foci));
}

}  // namespace palpa::acoustics
