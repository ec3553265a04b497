#include "setup/options/nulls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <optional>

#include "acoustics/air.hpp"
#include "acoustics/field/incident.hpp"
#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "array/field/free_field.hpp"
#include "array/field/split_rows.hpp"
#include "array/layouts/board_types.hpp"
#include "array/nulls/nulls.hpp"
#include "array/plausible.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "line/values.hpp"
#include "session/links/spec.hpp"
#include "setup/options/warnings.hpp"

namespace palpa::setup {
namespace {

constexpr double wanted_db = -40;
constexpr double least_kept = 0.5;
constexpr double least_db = -300;  // of a null without any sound

bool is_radius(double radius_m) {
  return radius_m >= 0 && radius_m <= array::most_null_radius_m;
}
std::string radius_hint() {
  return "give a radius from 0 to " + line::format_quantity(array::most_null_radius_m, Quantity::length);
}

/// Splits "x,y,z,r" into a place and a radius; without a fourth part, the radius is 0.
array::Null parse_null(const std::string& text) {
  std::string place = text;
  double radius_m = 0;
  if (std::ranges::count(text, ',') == 3) {
    const std::size_t comma = text.rfind(',');
    const std::optional<double> radius = parse_quantity(std::string_view(text).substr(comma + 1), Quantity::length);
    if (!radius || !is_radius(*radius)) {
      throw bad_usage(fmt::format("--null: '{}' is not x,y,z,r, such as 2cm,0,150mm,1mm; {}",
                                  shortened(printable(text), 60), radius_hint()));
    }
    radius_m = *radius;
    place = text.substr(0, comma);
  }
  const auto [x, y, z] = line::parse_point("--null", place);
  return {{x, y, z}, radius_m};
}

/// Places in a null where its sound is looked at: the centre, and two shells.
void add_places(const array::Null& null, std::vector<Vec3>& places) {
  places.push_back(null.position);
  if (!(null.radius_m > 0)) return;
  constexpr int count = 96;
  const double golden = std::numbers::pi * (1 + std::sqrt(5.0));
  for (const double part : {0.5, 1.0}) {
    for (int i = 0; i < count; ++i) {
      const double z = 1 - (2.0 * i + 1) / count, across = std::sqrt(1 - z * z), angle = golden * i;
      places.push_back(null.position +
                       part * null.radius_m * Vec3(across * std::cos(angle), across * std::sin(angle), z));
    }
  }
}

double decibels(double ratio) {
  return ratio > 0 ? std::max(least_db, 20 * std::log10(ratio)) : least_db;
}

/// A focus and a null, and |G_f G_n*| / (|G_f| |G_n|): 1 if no drive tells them apart.
struct NearestPair {
  std::size_t focus = 0, null = 0;
  double part = 0;
};
NearestPair nearest_pair(const array::Layout& layout, std::span<const array::SlotFocus> foci,
                         const array::DriveOptions& options) {
  std::vector<array::FocusSource> sources;
  for (const array::SlotFocus& focus : foci)
    sources.push_back({focus.position, 1, 1});
  array::FreeField field;
  field.set(layout, options.medium, options.directivity);
  array::Columns columns;
  field.fill(sources, array::Weighting::uniform, columns);
  array::SplitRows sounds;
  array::split_sounds(columns, sounds);
  const array::SplitRows& centres = options.nulls->centres();
  NearestPair nearest;
  for (std::size_t i = 0; i < centres.rows; ++i) {
    for (std::size_t j = 0; j < foci.size(); ++j) {
      const double own = array::inner_product(sounds, j, sounds, j).real();
      const double other = array::inner_product(centres, i, centres, i).real();
      const double part = std::abs(array::inner_product(sounds, j, centres, i)) / std::sqrt(own * other);
      if (part > nearest.part) nearest = {j, i, part};
    }
  }
  return nearest;
}

std::string name_of(std::span<const array::SlotFocus> foci, std::size_t focus, FocusNames names) {
  if (names == FocusNames::numbers) return fmt::format("focus {}", focus + 1);
  const Vec3 place = foci[focus].position * 1e3;
  return fmt::format("the focus at {:.1f}, {:.1f}, {:.1f} mm", place.x, place.y, place.z);
}

/// Empty if no focus is within a null.
std::string within_line(std::span<const array::SlotFocus> foci, std::span<const array::Null> nulls, FocusNames names) {
  for (std::size_t i = 0; i < nulls.size(); ++i) {
    for (std::size_t j = 0; j < foci.size(); ++j) {
      const double apart_m = glm::distance(nulls[i].position, foci[j].position);
      if (nulls[i].radius_m < apart_m) continue;
      return fmt::format("{} is within null {}, {:.2f} mm from its centre", name_of(foci, j, names), i + 1,
                         apart_m * 1e3);
    }
  }
  return {};
}

/// The pressure of the focus that lost most, relative to the drive without nulls.
double kept_of(const array::Layout& layout, const acoustics::FociPressure& pressure,
               std::span<const array::SlotFocus> foci, const array::DriveOptions& options, std::size_t& focus) {
  array::DriveOptions without = options;
  without.nulls.reset();
  const acoustics::FociPressure before = acoustics::pressure_at_foci(layout, array::drive_for(layout, foci, without),
                                                                     foci, options.medium, options.directivity);
  double kept = 1;
  for (std::size_t j = 0; j < foci.size(); ++j) {
    if (!(before.pascals[j] > 0) || pressure.pascals[j] / before.pascals[j] >= kept) continue;
    kept = pressure.pascals[j] / before.pascals[j];
    focus = j;
  }
  return kept;
}

}  // namespace

void add_null_option(const line::Group& group, FocusingOptions& options, const std::string& frame) {
  group.values("--null", options.nulls, "X,Y,Z[,R]",
               fmt::format("place in {} where the foci's sound is zero; R is the radius of a ball around it, 0 if you "
                           "leave it out; give it again for more places; goes with --solver gs-pat",
                           frame),
               parse_null);
}

void prepare_nulls(const FocusingOptions& group, const array::Layout& layout, array::DriveOptions& options) {
  if (group.nulls.empty()) return;
  if (layout.transducers.empty())
    throw bad_usage(group.nulls_from + ": there is no array whose sound could be zero anywhere");
  if (group.nulls.size() > array::most_nulls) {
    throw bad_usage(
        fmt::format("--null: {} nulls are more than the {} of a drive", group.nulls.size(), array::most_nulls));
  }
  for (std::size_t i = 0; i < group.nulls.size(); ++i) {
    const auto& [place, radius_m] = group.nulls[i];
    const std::string what = fmt::format("{}: null {} at {:.6g}, {:.6g}, {:.6g} mm", group.nulls_from, i + 1,
                                         1e3 * place.x, 1e3 * place.y, 1e3 * place.z);
    if (!is_radius(radius_m))
      throw bad_usage(fmt::format("{} has a radius of {} m; {}", what, radius_m, radius_hint()));
    refuse_place(layout, place, what);
    if (const std::string odd = array::implausible_place(layout, {place, place}); !odd.empty())
      throw bad_usage(fmt::format("{} {}", what, odd));
  }
  options.nulls = std::make_shared<const array::Nulls>(layout, options.medium, options.directivity, group.nulls);
}

Crowding crowding_of(const array::Layout& layout, std::span<const array::SlotFocus> foci,
                     const array::DriveOptions& options, FocusNames names) {
  const NearestPair worst = nearest_pair(layout, foci, options);
  Crowding crowding{.part = worst.part, .within = within_line(foci, options.nulls->nulls(), names)};
  if (worst.part < array::gs_pat_crowded) return crowding;
  crowding.line = fmt::format(
      "null {} is {:.2f} mm from {}, closer than the array resolves there: they share {:.2f} of the sound",
      worst.null + 1, glm::distance(options.nulls->nulls()[worst.null].position, foci[worst.focus].position) * 1e3,
      name_of(foci, worst.focus, names), worst.part);
  return crowding;
}

void check_nulls(const array::Layout& layout, std::span<const array::SlotFocus> foci,
                 const array::DriveOptions& options) {
  if (!options.nulls) return;
  const Crowding crowding = crowding_of(layout, foci, options, FocusNames::numbers);
  if (crowding.part >= array::gs_pat_same) throw bad_usage(crowding.line + "; give a null farther away");
  if (!crowding.within.empty()) throw bad_usage(crowding.within + "; give a smaller radius or a null farther away");
  if (!crowding.line.empty()) log::warning(crowding.line);
}

std::string coarse_boards_line(const std::string& link, const array::Layout& layout, array::Constraint constraint,
                               double gain) {
  const array::BoardType* const type = array::find_board_type(session::parse_spec(link).name);
  if (type == nullptr || std::ranges::find(layout.boards, type->name, &array::Board::type) == layout.boards.end())
    return {};
  const bool even = constraint != array::Constraint::normalise;  // `clamp`, too (array/nulls/null_drive.hpp)
  if (!type->has_amplitudes() && (!even || gain < 1)) {
    return fmt::format(
        "--null: the boards of --link {} have no amplitudes, and a ceiling or an intensity below 1 turns transducers "
        "off: nulls are only 10 to 30 dB below the foci; at full amplitude with --constraint uniform, they are about "
        "50 dB below",
        type->name);
  }
  if (!even && gain < type->few_amplitudes) {
    return fmt::format(
        "--null: below {:g} of the full amplitude, the boards of --link {} have few amplitudes: nulls are only 20 to "
        "40 dB below the foci; with --constraint uniform, they are about 50 dB below",
        gain, type->name);
  }
  return {};
}

std::string beside_weakest(double depth_db, int decimals) {
  return fmt::format("{:.{}f} dB {} the weakest focus", std::abs(depth_db), decimals, depth_db > 0 ? "above" : "below");
}

NullReport report_nulls(const array::Layout& layout, std::span<const array::TransducerDrive> drive,
                        std::span<const array::SlotFocus> foci, const array::DriveOptions& options, FocusNames names) {
  NullReport report;
  if (!options.nulls) return report;
  const acoustics::FociPressure pressure =
      acoustics::pressure_at_foci(layout, drive, foci, options.medium, options.directivity);
  const double weakest = *std::ranges::min_element(pressure.pascals);
  const acoustics::Air air =
      acoustics::without_absorption(acoustics::air_of({}, options.medium.frequency, options.medium.sound_speed));
  const acoustics::Incident sound(layout, air, options.directivity);
  acoustics::Waves waves;
  for (const array::Null& null : options.nulls->nulls()) {
    std::vector<Vec3> places;
    add_places(null, places);
    sound.at(places, {}, acoustics::strengths_of(drive), waves);
    SilentPlace place{.null = null, .loudest_pa = 0, .depth_db = least_db};
    for (const std::complex<double>& heard : waves.pressures)
      place.loudest_pa = std::max(place.loudest_pa, std::abs(heard));
    if (weakest > 0) place.depth_db = decibels(place.loudest_pa / weakest);
    report.places.push_back(place);
  }
  std::size_t focus = 0;
  report.kept = kept_of(layout, pressure, foci, options, focus);
  if (report.kept < least_kept) {
    report.quiet = fmt::format("{} has only {:.2f} of the pressure that it has without nulls",
                               name_of(foci, focus, names), report.kept);
  }
  const SilentPlace& loudest = *std::ranges::max_element(report.places, {}, &SilentPlace::depth_db);
  if (loudest.depth_db > wanted_db) {
    report.loud = fmt::format("null {} is {}{}", &loudest - report.places.data() + 1,
                              loudest.depth_db < 0 ? "only " : "", beside_weakest(loudest.depth_db, 1));
  }
  return report;
}

void warn_of_nulls(const NullReport& report) {
  for (const std::string& line : {report.quiet, report.loud}) {
    if (!line.empty()) log::warning(line);
  }
}

}  // namespace palpa::setup
