#include "cli/felt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "acoustics/felt/skin.hpp"
#include "acoustics/felt/tune.hpp"

namespace palpa::cli {
namespace {

const char* field_text(acoustics::FocusKind field) {
  switch (field) {
    case acoustics::FocusKind::spot:
      return "of spots";
    case acoustics::FocusKind::array:
      return "of the array's field";
    case acoustics::FocusKind::finger:
      break;
  }
  return "of the sound on the finger";
}

std::string shares(const acoustics::Felt& felt) {
  return fmt::format("{:.0f} % felt as vibration, {:.0f} % as flutter", 100 * felt.vibration, 100 * felt.flutter);
}

std::string spectrum_table(std::uint32_t finger, double perimeter_m, const acoustics::Spectrum& spectrum) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (spectrum.lines.empty()) return fmt::format("finger {}: its pressure does not change in time\n", finger);
  const std::string what = perimeter_m > 0
                               ? fmt::format("perimeter {:.1f} mm, {}", perimeter_m * 1e3, field_text(spectrum.field))
                               : "its foci stand still";
  fmt::format_to(out, "finger {}: {}: {}\n", finger, what, shares(acoustics::felt(spectrum)));
  // Pressures are relative to their mean over time; felt is weighted by the skin's sensitivity.
  fmt::format_to(out, "  frequency  pressure   phase  around    felt\n");
  fmt::format_to(out, "         Hz    x mean     rad  x mean  x mean\n");
  double most = 0;
  for (const acoustics::Line& line : spectrum.lines)
    most = std::max(most, acoustics::felt_as_vibration(line));
  // Lines that are not felt at all would only hide the others.
  for (const acoustics::Line& line : spectrum.lines) {
    if (acoustics::felt_as_vibration(line) < 0.02 * most) continue;
    fmt::format_to(out, "  {:9.1f}  {:8.3f}  {:6.2f}  {:6.3f}  {:6.3f}\n", line.frequency_hz, line.amplitude,
                   line.phase_rad, line.around, acoustics::felt_as_vibration(line));
  }
  return text;
}

std::string tune_line(std::uint32_t finger, const acoustics::Tuned& tuned) {
  const acoustics::Ring& ring = tuned.ring;
  if (!tuned.changed) {
    return fmt::format("finger {}: keeps {} foci, stride {} and {} ms, {}: {}\n", finger, ring.foci, ring.stride,
                       ring.dwell_s * 1e3, field_text(tuned.field), shares(tuned.after));
  }
  return fmt::format(
      "finger {}: tuned to {} foci, stride {}, {} ms for a perimeter of {:.1f} mm, {}: {}, instead of {}\n", finger,
      ring.foci, ring.stride, ring.dwell_s * 1e3, ring.perimeter_m * 1e3, field_text(tuned.field), shares(tuned.after),
      shares(tuned.before));
}

}  // namespace

std::string felt_lines(std::span<const session::ScheduledFinger> fingers,
                       std::span<const acoustics::Spectrum> spectra) {
  std::string text;
  for (std::uint32_t f = 0; f < fingers.size(); ++f) {
    if (fingers[f].tuned) text += tune_line(f, *fingers[f].tuned);
  }
  for (std::uint32_t f = 0; f < spectra.size(); ++f)
    text += spectrum_table(f, fingers[f].perimeter_m, spectra[f]);
  return text;
}

}  // namespace palpa::cli
