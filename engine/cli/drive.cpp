#include "setup/tasks/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "array/nulls/nulls.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/files/drive_file.hpp"
#include "setup/files/pattern_file.hpp"
#include "setup/options/nulls.hpp"
#include "setup/options/options.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/progress.hpp"
#include "setup/tasks/foci.hpp"

namespace palpa::cli {
namespace {

struct DriveCommand {
  setup::CommonOptions common;
  setup::DriveTask task;
  std::string csv;
};

void add_options_of_drive(CLI::App& app, DriveCommand& o) {
  const line::Group group(app, "What to drive");
  setup::add_layout(group, o.task.layout, "the array");
  group.texts("--focus", o.task.foci, "X,Y,Z[,A]", setup::focus_help, setup::check_focus_text);
  setup::add_null_option(group, o.task.drive, "the layout's own frame");
  group.text(
      "--pattern", o.task.pattern, "NAME|FILE",
      fmt::format("control points with wanted amplitudes, silent ones too, instead of --focus: {} (for the layout "
                  "paper) or a TOML",
                  setup::known_patterns()));
  group.text("--touch", o.task.touch, "FILE",
             "drives the foci of a touch that palpa touch --json wrote, instead of --focus");
  group.integer("--slot", o.task.slot, 0, std::numeric_limits<std::int32_t>::max(),
                "with --touch: slot of the schedule, counted from 0 [0]");
  group.text("--rig", o.task.rig, "FILE", "with --touch: TOML file with the array's pose [the layout's default pose]");
  group.text("--mesh", o.task.mesh, "FILE",
             "with --transfer finger: the finger, a closed PLY or glTF mesh in the layout's frame");
  setup::add_allow_outside(group, o.common);
  group.flag("--force", o.task.force, "also takes a finger whose faces are too coarse for the wavelength");
  group.text("--csv", o.csv, "FILE|-", "writes every transducer: index,x,y,z,nx,ny,nz,amplitude,phase");
  setup::add_spread_options(app, o.task.spread);
  setup::add_drive_options(app, o.task.drive, setup::FingerMesh::known);
  line::need(app, {"--slot", "--rig"}, "--touch");
  line::exclude(app, "--pattern", {"--focus", "--null", "--touch"});
}

/// A message about foci that are closer than the array resolves. It names the two that affect each other the most.
std::string unresolved_line(const setup::DriveResult& result) {
  const std::vector<array::FocusPair>& pairs = result.unresolved;
  const array::FocusPair& worst = *std::ranges::max_element(pairs, {}, &array::FocusPair::part);
  return fmt::format(
      "{} of foci closer than this array resolves there: the sound of focus {} has {:.2f} of its pressure {:.2f} mm "
      "away, at focus {}\n",
      counted(pairs.size(), "pair"), worst.first + 1, worst.part,
      glm::distance(result.foci[worst.first].position, result.foci[worst.second].position) * 1e3, worst.second + 1);
}

/// The differences on a finger.
std::string finger_line(const setup::DriveResult& result, std::size_t focus) {
  const Vec3& at = result.aimed[focus];
  std::string text = "  on the finger";
  if (at != result.foci[focus].position) {
    text = fmt::format("  on the nearest skin, at ({:.2f}, {:.2f}, {:.2f}) mm", at.x * 1e3, at.y * 1e3, at.z * 1e3);
  }
  if (!result.over_free_field.empty())
    text += fmt::format("; {:.2f} times the pressure of the drive for free air", result.over_free_field[focus]);
  return text + "\n";
}

std::string null_line(const setup::DriveResult& result, std::size_t number) {
  const setup::SilentPlace& place = result.nulls->places[number];
  const Vec3& at = place.null.position;
  const std::string within =
      place.null.radius_m > 0 ? fmt::format(" within {:.2f} mm", place.null.radius_m * 1e3) : std::string();
  const std::string built = result.spread
                                ? fmt::format("; {} Pa{} as built", range_text(result.spread->nulls_pa[number], 0),
                                              within.empty() ? "" : " at its centre")
                                : std::string();
  return fmt::format("null at ({:.2f}, {:.2f}, {:.2f}) mm: at most {:.3g} Pa{}, {}{}\n", at.x * 1e3, at.y * 1e3,
                     at.z * 1e3, place.loudest_pa, within, setup::beside_weakest(place.depth_db, 0), built);
}

std::string summary_of_drive(const setup::DriveResult& result) {
  const std::vector<array::SlotFocus>& foci = result.foci;
  float least = 1, most = 0;
  for (const array::TransducerDrive& d : result.drive) {
    least = std::min(least, d.amplitude);
    most = std::max(most, d.amplitude);
  }
  const array::Medium& air = result.medium;
  std::string text =
      fmt::format("{}: {} transducers, {} kHz, sound at {:.2f} m/s, wavelength {:.3f} mm\n", result.layout.name,
                  result.drive.size(), air.frequency / 1e3, air.sound_speed, 1e3 / air.turns_per_metre());
  for (std::size_t j = 0; j < foci.size(); ++j) {
    fmt::format_to(std::back_inserter(text), "focus at ({:.2f}, {:.2f}, {:.2f}) mm: {:.0f} Pa{}\n",
                   foci[j].position.x * 1e3, foci[j].position.y * 1e3, foci[j].position.z * 1e3,
                   result.pressure.pascals[j],
                   result.spread ? "; " + range_text(result.spread->pressures_pa[j], 0) + " Pa as built" : "");
    if (!result.aimed.empty()) text += finger_line(result, j);
  }
  if (foci.size() > 1)
    fmt::format_to(std::back_inserter(text), "weakest to strongest focus, relative to what was asked: {:.3f}{}\n",
                   result.pressure.evenness,
                   result.spread ? "; " + range_text(result.spread->evenness, 3) + " as built" : "");
  for (std::size_t i = 0; result.nulls && i < result.nulls->places.size(); ++i)
    text += null_line(result, i);
  if (result.spread) text += spread_line(result.spread->draws);
  if (!result.unresolved.empty()) text += unresolved_line(result);
  fmt::format_to(std::back_inserter(text), "amplitudes {:.3f} to {:.3f}; --csv or --json give every transducer\n",
                 least, most);
  return text + (result.beyond_linear() ? setup::linear_line() : "");
}

void run_drive(const DriveCommand& o) {
  check(o.task);
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}});
  std::optional<setup::Preparing> progress;
  const setup::DriveResult result = make_drive(o.task, o.common, [&] {
    log::release_warnings();
    progress.emplace(o.common.quiet);
  });
  progress.reset();
  if (!o.csv.empty()) write_file(o.csv, setup::drive_csv(result.layout, result.drive));
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_drive(result));
}

}  // namespace

void add_drive(Program& program) {
  add_subcommand<DriveCommand>(
      program,
      {"drive", "amplitude and phase of every transducer, for one or several foci",
       "  palpa drive --layout openmpd --focus 0,0,150mm --csv drive.csv\n"
       "  palpa drive --layout paper --focus 0,0,0 --focus 20mm,0,0,0.5 --solver gs-pat --json -",
       "--layout --focus --null --touch --slot --solver --constraint --pressure --frequency --csv",
       "Phases are delays in radians (time factor e^-iwt). Amplitudes are 0 to 1."},
      add_options_of_drive, run_drive);
}

}  // namespace palpa::cli
