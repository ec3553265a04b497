#include "acoustics/felt/spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <numbers>

#include "acoustics/field/asked_field.hpp"
#include "base/error.hpp"

namespace palpa::acoustics {
namespace {

using array::Modulation;
using array::SlotFocus;
using array::Voice;
using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr std::uint64_t most_slots = 1024;

double sinc(double x) {
  return x == 0 ? 1 : std::sin(pi * x) / (pi * x);
}

/// e^{2 pi i turns}
Complex at_turn(double turns) {
  const double angle = 2 * pi * (turns - std::floor(turns));
  return {std::cos(angle), std::sin(angle)};
}

double spot(double distance_m, double fwhm_m) {
  const double x = distance_m / fwhm_m;
  return std::exp(-4 * std::numbers::ln2 * x * x);
}

/// Adds up skin points one after the other. The phases of the first point are kept.
class Lines {
 public:
  Lines(std::size_t pieces, double piece_s, const SpectrumOptions& options) : pieces_(pieces) {
    period_s_ = piece_s * static_cast<double>(pieces);
    // A small margin, so that a line exactly at the limit is not lost to rounding.
    const auto count = static_cast<std::size_t>(std::max(0.0, options.highest_hz * period_s_ * (1 + 1e-12)));
    first_.resize(count);
    square_.resize(count);
    for (std::size_t k = 0; k < pieces; ++k)
      phasors_.push_back(std::conj(at_turn(static_cast<double>(k) / static_cast<double>(pieces))));
  }

  /// The pressures of one skin point, one value per piece. The point represents `weight` of the perimeter.
  void add(std::span<const double> pressures, double weight) {
    const auto n = static_cast<double>(pieces_);
    double mean = 0, square = 0;
    for (const double p : pressures) {
      mean += p / n;
      square += p * p / n;
    }
    for (std::size_t i = 0; i < first_.size(); ++i) {
      const std::size_t m = i + 1;
      Complex c = 0;
      for (std::size_t k = 0; k < pieces_; ++k)
        c += pressures[k] * phasors_[m * k % pieces_];
      const double x = static_cast<double>(m) / n;
      c *= 2 / n * sinc(x) * std::conj(at_turn(x / 2));
      square_[i] += weight * std::norm(c);
      if (!begun_) first_[i] = mean > 0 ? c / mean : 0;
    }
    mean_ += weight * mean;
    variance_ += weight * std::max(0.0, square - mean * mean);
    weight_ += weight;
    begun_ = true;
  }

  Spectrum spectrum(const Vec3& skin) const {
    const double mean = mean_ / weight_;
    Spectrum out;
    out.skin = skin;
    if (!(mean > 0)) return out;
    out.variance = variance_ / weight_ / (mean * mean);
    out.period_s = period_s_;
    for (std::size_t i = 0; i < first_.size(); ++i) {
      const double x = static_cast<double>(i + 1) / static_cast<double>(pieces_);
      out.lines.push_back({static_cast<double>(i + 1) / period_s_, std::abs(first_[i]), std::arg(first_[i]),
                           std::sqrt(square_[i] / weight_) / mean, std::abs(sinc(x))});
    }
    return out;
  }

 private:
  std::size_t pieces_;
  double period_s_ = 0;
  std::vector<Complex> phasors_;  ///< e^{-2 pi i k / pieces}
  std::vector<Complex> first_;    ///< 2 c_m / mean of the first point
  std::vector<double> square_;    ///< sum of |2 c_m|^2
  double mean_ = 0, variance_ = 0, weight_ = 0;
  bool begun_ = false;
};

/// Foci that stand still: the pressure at every skin point is proportional to the square of the gain, s(t) = sum over h
/// of a_h e^{2 pi i h f t}, sampled at the slots' midpoints and held. That has the lines h f + n / slot with the
/// coefficients a_h (-1)^n sinc((h f + n / slot) slot).
Spectrum still_spectrum(const Voice& voice, double slot_s, const SpectrumOptions& options) {
  Spectrum out;
  out.skin = options.field ? options.field->skin_at(voice.foci.front()) : voice.foci.front();
  out.field = kind_of(options.field);
  if (voice.modulation_hz == 0) return out;
  // (1 + sin)/2, and its square 3/8 + sin/2 - cos(2 ..)/8; index h + 2.
  const bool pressure = voice.modulation == Modulation::pressure_sine;
  const std::array<Complex, 5> a =
      pressure ? std::array<Complex, 5>{0, Complex(0, 0.25), 0.5, Complex(0, -0.25), 0}
               : std::array<Complex, 5>{-1.0 / 16, Complex(0, 0.25), 0.375, Complex(0, -0.25), -1.0 / 16};
  struct Term {
    double turns;  ///< per slot, not negative
    Complex c;
  };
  std::vector<Term> terms;
  const double per_slot = voice.modulation_hz * slot_s;
  const auto images = static_cast<int>(std::min(1e5, std::ceil(options.highest_hz * slot_s) + 2 * per_slot + 1));
  for (int h = -2; h <= 2; ++h) {
    const Complex coefficient = a[static_cast<std::uint32_t>(h + 2)];
    if (coefficient == Complex(0)) continue;
    for (int n = -images; n <= images; ++n) {
      const double turns = h * per_slot + n;
      // Lines of negative frequency are mirror images of the others.
      if (turns > -1e-9) terms.push_back({std::abs(turns), coefficient * (n % 2 == 0 ? 1.0 : -1.0) * sinc(turns)});
    }
  }
  std::sort(terms.begin(), terms.end(), [](const Term& l, const Term& r) { return l.turns < r.turns; });
  double mean = 0;
  for (std::size_t i = 0; i < terms.size();) {
    // Components at the same frequency add up.
    const double turns = terms[i].turns;
    Complex c = 0;
    for (; i < terms.size() && terms[i].turns - turns < 1e-9; ++i)
      c += terms[i].c;
    if (turns < 1e-9) {
      mean = c.real();
      continue;
    }
    const double hz = turns / slot_s, amplitude = 2 * std::abs(c);
    if (amplitude > 1e-12 && hz <= options.highest_hz * (1 + 1e-12))
      out.lines.push_back({hz, amplitude, std::arg(c), amplitude, std::abs(sinc(turns))});
  }
  if (!(mean > 0)) return Spectrum{out.skin, 0, {}, 0, out.field};
  for (Line& line : out.lines) {
    line.amplitude /= mean;
    line.around /= mean;
  }
  // Variance of the held samples. Each component counts at its alias among the samples.
  Complex folded[5];
  double folded_turns[5];
  std::size_t count = 0;
  for (int h = -2; h <= 2; ++h) {
    const double turns = h * per_slot - std::floor(h * per_slot);
    std::size_t same = 0;
    while (same < count && std::abs(std::remainder(folded_turns[same] - turns, 1.0)) > 1e-9)
      ++same;
    if (same == count) {
      folded[count] = 0;
      folded_turns[count++] = turns;
    }
    folded[same] += a[static_cast<std::uint32_t>(h + 2)] * at_turn(h * per_slot / 2);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(std::remainder(folded_turns[i], 1.0)) > 1e-9) out.variance += std::norm(folded[i]) / (mean * mean);
  }
  return out;
}

/// The pressure of every focus alone at every place of the path through them, entry [focus * places + place].
void spot_pressures(std::span<const Vec3> foci, std::span<const Vec3> path, double fwhm_m, std::vector<double>& out) {
  out.clear();
  for (const Vec3& focus : foci) {
    for (const Vec3& place : path)
      out.push_back(spot(glm::distance(focus, place), fwhm_m));
  }
}

/// An entry of a slot: a focus of the voice, and its squared gain.
struct Sounding {
  std::size_t focus;
  double weight;
};

/// The voice's slots before the `cycle`-th, as in foci_of_slot, with the numbers of the foci instead of their
/// positions.
std::vector<std::vector<Sounding>> slots_of(const array::Schedule& alone, std::uint64_t cycle) {
  array::Schedule numbered = alone;
  std::vector<Vec3>& foci = numbered.voices[0].foci;
  for (std::size_t i = 0; i < foci.size(); ++i)
    foci[i] = Vec3(static_cast<double>(i), 0, 0);
  std::vector<std::vector<Sounding>> slots(cycle);
  std::vector<SlotFocus> sounding;
  for (std::uint64_t slot = 0; slot < cycle; ++slot) {
    foci_of_slot(numbered, slot, sounding);
    for (const SlotFocus& focus : sounding)
      slots[slot].push_back({static_cast<std::size_t>(focus.position.x), double{focus.gain} * double{focus.gain}});
  }
  return slots;
}

}  // namespace

Spectrum spectrum_of(const Voice& voice, double slot_s, const SpectrumOptions& options) {
  if (voice.foci.empty() || voice.order.empty() || voice.foci_per_slot == 0) return {};
  if (voice.order.size() <= voice.foci_per_slot) return still_spectrum(voice, slot_s, options);
  array::Schedule alone;
  alone.slot_s = slot_s;
  alone.add_voice() = voice;
  alone.voices[0].course = {};
  const std::uint64_t cycle = array::cycle_length(alone, most_slots);
  if (cycle == 0) {
    throw bad_usage(
        fmt::format("a dwell of {} ms in slots of {} ms does not repeat within {} slots, so its spectrum "
                    "cannot be shown; choose round numbers",
                    voice.dwell_s * 1e3, slot_s * 1e3, most_slots));
  }
  const std::vector<std::vector<Sounding>> slots = slots_of(alone, cycle);
  const std::size_t per_side = options.field ? steps_per_side(voice.foci, options.field->step_m()) : 8;
  const std::vector<Vec3> path = path_through(voice.foci, per_side);
  std::vector<double> table, pressures(cycle);
  if (options.field) {
    // A finger's field already uses the drives for the requested pressure.
    const AskedField asked(*options.field);
    const bool by_pressure = voice.pressure_pa && options.field->kind() == FocusKind::array;
    const FocusField& field = by_pressure ? asked : *options.field;
    field.felt(path, per_side, table);
  } else {
    spot_pressures(voice.foci, path, options.fwhm_m, table);
  }
  Lines lines(cycle, slot_s, options);
  for (std::size_t place = 0; place < path.size(); ++place) {
    for (std::uint64_t slot = 0; slot < cycle; ++slot) {
      pressures[slot] = 0;
      for (const Sounding& sounding : slots[slot])
        pressures[slot] += sounding.weight * table[sounding.focus * path.size() + place];
    }
    // If an empty sector plays its neighbour's focus, the side has no length. The tiny length is for foci that are all
    // in one place.
    const std::size_t side = place / per_side;
    lines.add(pressures, glm::distance(voice.foci[side], voice.foci[(side + 1) % voice.foci.size()]) + 1e-12);
  }
  Spectrum spectrum = lines.spectrum(options.field ? options.field->skin_at(path.front()) : path.front());
  spectrum.field = kind_of(options.field);
  return spectrum;
}

Spectrum spectrum_of(const Ring& ring, const SpectrumOptions& options) {
  if (!(ring.perimeter_m > 0)) return {};
  const std::vector<std::uint32_t> order = array::fill_order(ring.foci, ring.stride);
  const auto count = static_cast<double>(ring.foci);
  // The curve is closed, so a focus is met again after every turn.
  const int turns = std::min(1000, static_cast<int>(std::ceil(3 * options.fwhm_m / ring.perimeter_m)) + 1);
  Lines lines(ring.foci, ring.dwell_s, options);
  constexpr int per_side = 8;
  std::vector<double> pressures(ring.foci);
  for (int step = 0; step < per_side; ++step) {
    for (std::uint32_t k = 0; k < ring.foci; ++k) {
      const double along = (step / double{per_side} - order[k]) / count;
      pressures[k] = 0;
      for (int turn = -turns; turn <= turns; ++turn)
        pressures[k] += spot((along + turn) * ring.perimeter_m, options.fwhm_m);
    }
    lines.add(pressures, 1);
  }
  return lines.spectrum({});
}

}  // namespace palpa::acoustics
