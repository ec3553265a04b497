#include "cli/felt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace palpa::cli {
namespace {

double felt(const acoustics::Line& line) {
  return acoustics::skin_sensitivity(line.frequency_hz) * line.around;
}

}  // namespace

void add_spectrum(JsonWriter& json, double perimeter_m, const acoustics::Spectrum& spectrum) {
  json.key("spectrum").begin_object().member("perimeter_m", perimeter_m).member("skin_m", glm::vec3(spectrum.skin));
  json.member("period_s", spectrum.period_s).member("variance", spectrum.variance);
  json.member("felt_share", acoustics::felt_share(spectrum));
  json.key("lines").begin_array(JsonWriter::Style::rows);
  for (const acoustics::Line& line : spectrum.lines) {
    json.begin_object().member("frequency_hz", line.frequency_hz).member("amplitude", line.amplitude);
    json.member("phase_rad", line.phase_rad).member("around", line.around).member("hold", line.hold);
    json.member("felt", felt(line)).end_object();
  }
  json.end_array().end_object();
}

void add_tune(JsonWriter& json, const acoustics::Tuned& tuned) {
  json.key("tune").begin_object().member("perimeter_m", tuned.ring.perimeter_m).member("foci", tuned.ring.foci);
  json.member("stride", tuned.ring.stride).member("dwell_s", tuned.ring.dwell_s);
  json.member("felt_share_before", tuned.share_before).member("felt_share", tuned.share).end_object();
}

std::string spectrum_table(std::uint32_t finger, double perimeter_m, const acoustics::Spectrum& spectrum) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (spectrum.lines.empty()) return fmt::format("finger {}: its pressure does not change in time\n", finger);
  fmt::format_to(out, "finger {}: {}; skin is sensitive to {:.0f} % of its vibration\n", finger,
                 perimeter_m > 0 ? fmt::format("perimeter {:.1f} mm", perimeter_m * 1e3) : "its foci stand still",
                 100 * acoustics::felt_share(spectrum));
  fmt::format_to(out, "      Hz  pressure   phase  around    felt\n");
  double most = 0;
  for (const acoustics::Line& line : spectrum.lines)
    most = std::max(most, felt(line));
  // What is not felt at all would only hide the rest.
  for (const acoustics::Line& line : spectrum.lines) {
    if (felt(line) < 0.02 * most) continue;
    fmt::format_to(out, "  {:6.1f}  {:8.3f}  {:6.2f}  {:6.3f}  {:6.3f}\n", line.frequency_hz, line.amplitude,
                   line.phase_rad, line.around, felt(line));
  }
  return text;
}

std::string tune_line(std::uint32_t finger, const acoustics::Tuned& tuned) {
  const acoustics::Ring& ring = tuned.ring;
  if (!tuned.changed) {
    return fmt::format("finger {}: {} foci, stride {} and {} ms stay: skin is sensitive to {:.0f} % of the vibration\n",
                       finger, ring.foci, ring.stride, ring.dwell_s * 1e3, 100 * tuned.share);
  }
  return fmt::format(
      "finger {}: tuned to {} foci, stride {}, {} ms for a perimeter of {:.1f} mm: skin is sensitive to {:.0f} % of "
      "the "
      "vibration instead of {:.0f} %\n",
      finger, ring.foci, ring.stride, ring.dwell_s * 1e3, ring.perimeter_m * 1e3, 100 * tuned.share,
      100 * tuned.share_before);
}

}  // namespace palpa::cli
