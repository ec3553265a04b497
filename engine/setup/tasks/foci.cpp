#include "setup/tasks/foci.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "array/drive.hpp"
#include "array/loudness.hpp"
#include "array/plausible.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/units.hpp"
#include "line/values.hpp"
#include "session/watch/pressure_log.hpp"
#include "setup/files/drive_file.hpp"
#include "setup/options/warnings.hpp"

namespace palpa::setup {
namespace {

/// Splits "x,y,z,a" into "x,y,z" and a; without a fourth part, a is 1.
std::pair<std::string, float> split_gain(const std::string& text) {
  if (std::ranges::count(text, ',') != 3) return {text, 1.0F};
  const std::size_t comma = text.rfind(',');
  float gain = 0;
  const std::string_view number = without_plus(std::string_view(text).substr(comma + 1));
  const char* const end = number.data() + number.size();
  const auto [rest, fault] = std::from_chars(number.data(), end, gain);
  if (fault != std::errc{} || rest != end || !(gain > 0 && gain <= 1)) {
    throw bad_usage(fmt::format("--focus: '{}' is not x,y,z,a with a above 0 and at most 1, such as 0,0,150mm,0.5",
                                text.substr(0, 60)));
  }
  return {text.substr(0, comma), gain};
}

AskedFocus parse_focus(const std::string& text) {
  const auto [place, gain] = split_gain(text);
  const auto [x, y, z] = line::parse_point("--focus", place);
  return {{x, y, z}, gain};
}

void add_voice(const AskedFocus& focus, const array::Layout& layout, const std::string& name,
               array::Schedule& schedule) {
  array::Voice& voice = schedule.add_voice();
  voice.foci = {focus.position};
  voice.order = {0};
  voice.gain = focus.gain;
  check_focus(layout, {focus.position, focus.gain}, name);
}

}  // namespace

void check_focus_text(const std::string& text) {
  parse_focus(text);
}

void check_pressure(std::optional<double> pressure_pa) {
  if (pressure_pa && !(*pressure_pa > 0 && *pressure_pa <= array::most_pressure_pa)) {
    throw bad_usage(fmt::format("a pressure of {} Pa at each focus is not above 0 and at most {} Pa", *pressure_pa,
                                array::most_pressure_pa));
  }
}

void check_drive(const array::Layout& layout, std::span<const array::TransducerDrive> drive) {
  if (drive.size() != layout.transducers.size()) {
    throw bad_usage(fmt::format("the drive belongs to another layout: it has {} transducers, but {} has {}",
                                drive.size(), layout.name, layout.transducers.size()));
  }
  if (drive.empty()) throw bad_usage(fmt::format("the layout {} has no transducers", layout.name));
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const auto [amplitude, phase] = drive[i];
    if (!as_given_amplitude(double{amplitude}))
      throw bad_usage(fmt::format("the drive's amplitude {} of transducer {} is not within 0..1", amplitude, i));
    if (!(std::abs(phase) <= most_phase_rad))
      throw bad_usage(fmt::format("the drive's phase {} of transducer {} is more than a million turns", phase, i));
  }
}

void check_focus(const array::Layout& layout, const array::SlotFocus& focus, const std::string& what) {
  refuse_place(layout, focus.position, what);
  if (const std::string odd = array::implausible_place(layout, {focus.position, focus.position}); !odd.empty())
    log::warning(what + " " + odd);
}

array::Schedule schedule_of(std::span<const AskedFocus> foci, const array::Layout& layout) {
  array::Schedule schedule;
  for (std::size_t i = 0; i < foci.size(); ++i) {
    const std::string name = fmt::format("focus {}", i + 1);
    if (!(foci[i].gain > 0 && foci[i].gain <= 1))
      throw bad_usage(fmt::format("{}: a gain of {} is not above 0 and at most 1", name, foci[i].gain));
    add_voice(foci[i], layout, name, schedule);
  }
  return schedule;
}

array::Schedule schedule_of(std::span<const std::string> foci, const array::Layout& layout) {
  array::Schedule schedule;
  for (const std::string& text : foci)
    add_voice(parse_focus(text), layout, fmt::format("--focus: '{}'", text), schedule);
  return schedule;
}

std::vector<std::complex<double>> factors_for(const array::Layout& layout, array::Schedule& schedule,
                                              const array::DriveOptions& options, const std::string& touch) {
  if (!array::Loudness::asked(schedule)) return {};
  array::Loudness loudness(layout, options);
  loudness.solve(schedule, 1);
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const array::Voice& voice = schedule.voices[v];
    const double asked = voice.asked_pa(), reached = *voice.reached_pa;
    if (session::is_reached(asked, reached)) continue;
    const std::string who =
        touch.empty() ? fmt::format("--pressure: focus {}", v + 1) : fmt::format("{}: finger {}", touch, voice.id);
    log::warning(fmt::format("{} has {:.0f} Pa of the {:.0f} Pa that are asked for: the array cannot give more", who,
                             reached, asked));
  }
  const auto factors = loudness.factors(0);
  return {factors.begin(), factors.end()};
}

array::Drive drive_on_cpu(const array::Layout& layout, std::span<const array::SlotFocus> foci,
                          std::span<const std::complex<double>> factors, const array::DriveOptions& options) {
  if (factors.empty()) return array::drive_for(layout, foci, options);
  array::Drive drive(layout.transducers.size());
  array::DriveScratch scratch;
  array::drive_by_factors(layout, foci, factors, options, drive, scratch);
  return drive;
}

}  // namespace palpa::setup
