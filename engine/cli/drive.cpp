#include "array/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/finger_transfer.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/pressure.hpp"
#include "array/drive_pass.hpp"
#include "array/layout.hpp"
#include "array/resolution.hpp"
#include "array/schedule.hpp"
#include "array/usual.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "cli/foci_drive.hpp"
#include "gpu/commands.hpp"
#include "gpu/device.hpp"
#include "setup/body.hpp"
#include "setup/drive_file.hpp"
#include "setup/load.hpp"
#include "setup/options.hpp"
#include "setup/progress.hpp"
#include "setup/touch_file.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"
#include "touch/foci/method.hpp"

namespace palpa::cli {
namespace {

struct DriveCommand {
  setup::CommonOptions common;
  std::string layout;
  std::vector<std::string> foci;
  std::string touch, rig;
  std::optional<std::uint32_t> slot;
  setup::DriveOptionsGroup drive;
  std::string mesh;
  bool force = false;
  std::string csv;
};

void add_options(CLI::App& app, DriveCommand& o) {
  const setup::Group group(app, "What to drive");
  group.text("--layout", o.layout, "NAME|FILE", "autd3, paper, openmpd, openmpd-pair, sonicsurface or a layout TOML");
  group.texts("--focus", o.foci, "X,Y,Z[,A]", focus_help);
  group.text("--touch", o.touch, "FILE", "in place of --focus: what sounds of the touch that palpa touch --json wrote");
  group.integer("--slot", o.slot, 0, std::numeric_limits<std::int32_t>::max(), "of that touch's order [0]");
  group.text("--rig", o.rig, "FILE", "where the array stands for that touch [where --layout stands by default]");
  group.text("--mesh", o.mesh, "FILE",
             "with --transfer finger: that finger, a closed PLY or glTF mesh in the layout's frame");
  add_allow_outside(group, o.common);
  group.flag("--force", o.force, "focus on a finger that is too coarse for the wavelength, too");
  group.text("--csv", o.csv, "FILE|-", "index,x,y,z,nx,ny,nz,amplitude,phase of every transducer");
  setup::add_drive_options(app, o.drive, setup::FingerMesh::known);
}

/// What sounds in the touch's slot, in the layout's frame, as a schedule of one slot: a voice per finger, and none for
/// one that is silent (`gain` 0).
array::Schedule slot_of_touch(const DriveCommand& o, const array::Schedule& touch, const setup::PlacedLayout& placed) {
  constexpr std::uint64_t longest_cycle = 1u << 20;
  const std::uint32_t slot = o.slot.value_or(0);
  if (const std::uint64_t cycle = array::cycle_length(touch, longest_cycle); cycle != 0 && slot >= cycle) {
    throw bad_usage(fmt::format("--slot: {} is not there: {} has {}", slot, o.touch,
                                cycle == 1 ? "one slot, 0" : fmt::format("the slots 0 to {}", cycle - 1)));
  }
  std::vector<array::SlotFocus> foci;
  array::foci_of_slot(touch, slot, foci);
  const Transform T_layout_world = glm::inverse(placed.T_world_layout);
  array::Schedule schedule;
  for (const array::SlotFocus& focus : foci) {
    if (focus.gain == 0) continue;
    const array::Voice& finger = touch.voices[focus.voice];
    const bool another = schedule.voice_count == 0 || schedule.voices[schedule.voice_count - 1].id != finger.id;
    array::Voice& voice = another ? schedule.add_voice() : schedule.voices[schedule.voice_count - 1];
    if (another) {
      voice.id = finger.id;
      voice.gain = finger.gain;
      voice.pressure_pa = finger.pressure_pa;
      voice.foci_per_slot = 0;
    }
    voice.foci.push_back(transform_point(T_layout_world, focus.position));
    voice.order.push_back(voice.foci_per_slot++);
    check_focus(placed.layout, {voice.foci.back(), focus.gain},
                fmt::format("{}: the focus of finger {}", o.touch, finger.id));
  }
  if (schedule.voice_count == 0) throw bad_input(o.touch, "every finger of this touch is silent: its gain is 0");
  return schedule;
}

array::Drive drive_on_gpu(const gpu::DeviceOptions& select, const array::Layout& layout,
                          const std::vector<array::SlotFocus>& foci, std::span<const std::complex<double>> factors,
                          const array::DriveOptions& options) {
  const gpu::Device device(select);
  const array::DrivePasses passes(device, factors.empty() ? options.solver : array::Solver::naive);
  array::DriveMemory buffers(device, layout, options, 1, static_cast<std::uint32_t>(foci.size()));
  const bool fits = factors.empty() ? buffers.add_slot(foci) : buffers.add_slot(foci, factors);
  if (!fits) throw failure("more foci than the GPU's buffers hold");
  const gpu::Recorder recorder(device, "drive");
  gpu::Timeline timeline(device);
  buffers.record(recorder.begin(), passes);
  timeline.wait(timeline.submit(recorder.end()));
  const auto drive = buffers.drive(0);
  return {drive.begin(), drive.end()};
}

/// A finger in the layout's frame, and what the transducers do to it.
struct ScatteringFinger {
  acoustics::RigidBody body;
  acoustics::FingerTransfer sound;
  std::vector<Vec3> aimed;    ///< where each focus is: on the skin
  std::vector<double> gains;  ///< pressure over that of the drive for the same foci in free air; none with --pressure

  ScatteringFinger(geometry::Mesh mesh, const array::Layout& layout, const acoustics::Air& air,
                   array::Directivity directivity)
      : body(std::move(mesh), air.wave_number()), sound(body, layout, air, directivity) {}
};

std::unique_ptr<ScatteringFinger> finger_of(const DriveCommand& o, const array::Layout& layout,
                                            const array::DriveOptions& options,
                                            const std::vector<array::SlotFocus>& foci) {
  if (o.mesh.empty()) return nullptr;
  // Without absorption, as in the solvers.
  const acoustics::Air air = acoustics::without_absorption(setup::air(o.drive.medium, {}));
  geometry::Mesh mesh = setup::load_body(o.mesh, air, o.force);
  acoustics::check_clear_of(o.mesh, mesh, layout);
  log::release_warnings();
  const setup::Preparing progress(o.common.quiet);
  auto finger = std::make_unique<ScatteringFinger>(std::move(mesh), layout, air, options.directivity);
  std::vector<Vec3> places;
  places.reserve(foci.size());
  for (const array::SlotFocus& focus : foci)
    places.push_back(focus.position);
  finger->aimed = finger->sound.aim(places);
  return finger;
}

std::string to_json(const array::Layout& layout, const std::vector<array::SlotFocus>& foci, const array::Medium& air,
                    const array::Drive& drive, const acoustics::FociPressure& pressure,
                    const std::vector<array::FocusPair>& unresolved, const ScatteringFinger* finger) {
  JsonWriter json;
  json.begin_object()
      .member("layout", layout.name)
      .member("transducers", std::uint64_t{drive.size()})
      .member("sound_speed_m_s", air.sound_speed)
      .member("frequency_hz", air.frequency);
  json.key("foci_m").begin_array();
  for (const array::SlotFocus& focus : foci)
    json.value(focus.position);
  json.end_array();
  if (finger) {
    json.key("aimed_m").begin_array();
    for (const Vec3& place : finger->aimed)
      json.value(place);
    json.end_array();
  }
  json.key("gains").begin_array();
  for (const array::SlotFocus& focus : foci)
    json.value(focus.gain);
  json.end_array();
  json.key("pressures_pa").begin_array();
  for (const double pascals : pressure.pascals)
    json.value(pascals);
  json.end_array().member("weakest_to_strongest", pressure.evenness);
  if (finger && !finger->gains.empty()) {
    json.key("over_free_field").begin_array();
    for (const double gain : finger->gains)
      json.value(gain);
    json.end_array();
  }
  json.key("unresolved_pairs").begin_array();
  for (const array::FocusPair& pair : unresolved)
    json.begin_array().value(std::uint64_t{pair.first}).value(std::uint64_t{pair.second}).end_array();
  json.end_array();
  json.key("amplitudes").begin_array();
  for (const array::TransducerDrive& d : drive)
    json.value(d.amplitude);
  json.end_array();
  json.key("phases_rad").begin_array();
  for (const array::TransducerDrive& d : drive)
    json.value(d.phase);
  json.end_array().end_object();
  return json.take();
}

/// Closer than the array resolves: said of the two that are heard at each other the most.
std::string unresolved_line(const std::vector<array::SlotFocus>& foci, const std::vector<array::FocusPair>& pairs) {
  const array::FocusPair& worst = *std::ranges::max_element(pairs, {}, &array::FocusPair::part);
  return fmt::format(
      "{} of foci closer than this array resolves there: of what focus {} gives, {:.2f} is heard {:.2f} mm away at "
      "focus "
      "{}\n",
      pairs.size() == 1 ? "1 pair" : fmt::format("{} pairs", pairs.size()), worst.first + 1, worst.part,
      glm::distance(foci[worst.first].position, foci[worst.second].position) * 1e3, worst.second + 1);
}

/// Of each focus, against the drive that free air asks for.
std::vector<double> gains_over(const array::DriveOptions& in_free_air, const array::Layout& layout,
                               const std::vector<array::SlotFocus>& foci, const ScatteringFinger& finger,
                               const acoustics::FociPressure& pressure) {
  const array::Drive other = array::drive_for(layout, foci, in_free_air);
  const acoustics::FociPressure before = acoustics::pressure_at_foci(layout, other, foci, finger.sound);
  std::vector<double> gains;
  gains.reserve(foci.size());
  for (std::size_t j = 0; j < foci.size(); ++j)
    gains.push_back(before.pascals[j] > 0 ? pressure.pascals[j] / before.pascals[j] : 0);
  return gains;
}

/// What is different on a finger.
std::string finger_line(const ScatteringFinger& finger, std::size_t focus, const Vec3& asked) {
  const Vec3& at = finger.aimed[focus];
  std::string text = "  on the finger";
  if (at != asked) {
    text = fmt::format("  on the nearest skin, at ({:.2f}, {:.2f}, {:.2f}) mm", at.x * 1e3, at.y * 1e3, at.z * 1e3);
  }
  if (!finger.gains.empty())
    text += fmt::format("; {:.2f} times what the drive for free air gives there", finger.gains[focus]);
  return text + "\n";
}

std::string summary(const array::Layout& layout, const std::vector<array::SlotFocus>& foci, const array::Medium& air,
                    const array::Drive& drive, const acoustics::FociPressure& pressure,
                    const std::vector<array::FocusPair>& unresolved, const ScatteringFinger* finger) {
  float least = 1, most = 0;
  for (const array::TransducerDrive& d : drive) {
    least = std::min(least, d.amplitude);
    most = std::max(most, d.amplitude);
  }
  std::string text = fmt::format("{}: {} transducers, {} kHz, sound at {:.2f} m/s, wavelength {:.3f} mm\n", layout.name,
                                 drive.size(), air.frequency / 1e3, air.sound_speed, 1e3 / air.turns_per_metre());
  for (std::size_t j = 0; j < foci.size(); ++j) {
    fmt::format_to(std::back_inserter(text), "focus at ({:.2f}, {:.2f}, {:.2f}) mm: {:.0f} Pa\n",
                   foci[j].position.x * 1e3, foci[j].position.y * 1e3, foci[j].position.z * 1e3, pressure.pascals[j]);
    if (finger) text += finger_line(*finger, j, foci[j].position);
  }
  if (foci.size() > 1)
    fmt::format_to(std::back_inserter(text), "weakest to strongest focus: {:.3f} of what was asked\n",
                   pressure.evenness);
  if (!unresolved.empty()) text += unresolved_line(foci, unresolved);
  fmt::format_to(std::back_inserter(text), "amplitudes {:.3f} to {:.3f}; --csv or --json give every transducer\n",
                 least, most);
  return text;
}

void check(const DriveCommand& o) {
  const std::string asks = setup::asks_for_finger(o.drive);
  if (!asks.empty() && o.mesh.empty())
    throw bad_usage(asks + ": --mesh is missing: give the finger's closed mesh, in the layout's frame");
  if (asks.empty() && (!o.mesh.empty() || o.force))
    throw bad_usage(fmt::format("{} goes with --transfer finger", o.mesh.empty() ? "--force" : "--mesh"));
  if (o.touch.empty()) {
    if (o.slot || !o.rig.empty()) throw bad_usage(fmt::format("{} goes with --touch", o.slot ? "--slot" : "--rig"));
    if (o.layout.empty())
      throw bad_usage("--layout is missing: give autd3, paper, openmpd, openmpd-pair, sonicsurface or a layout TOML");
    if (o.foci.empty()) {
      throw bad_usage(
          "--focus is missing: give a point x,y,z in the layout's frame, such as 0,0,150mm, or a --touch FILE");
    }
    return;
  }
  if (!o.foci.empty()) throw bad_usage("--focus and --touch exclude each other: give one of them");
  if (o.layout.empty() && o.rig.empty())
    throw bad_usage("--touch needs an array: give --layout, or the --rig that it stands in");
}

/// Refuses fingers that ask for a pressure beside what it takes the place of.
void check_pressures(const DriveCommand& o, const array::Schedule& touch) {
  for (const array::Voice& finger : touch.voices) {
    if (finger.pressure_pa > 0)
      setup::refuse_beside_pressure(o.drive, fmt::format("finger {} of {} asks for a pressure", finger.id, o.touch));
  }
}

void run(const DriveCommand& o) {
  check(o);
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}});
  const setup::PlayedTouch played = o.touch.empty() ? setup::PlayedTouch() : setup::load_touch(o.touch);
  array::DriveOptions options =
      setup::drive_options(o.drive, played.together ? touch::Method::multi_focus : touch::Method::cross_section,
                           o.mesh.empty() ? setup::FingerMesh::unknown : setup::FingerMesh::known);
  check_pressures(o, played.schedule);
  const setup::PlacedLayout placed = setup::load_placed_layout({.rig = o.rig, .layout = o.layout});
  const array::Layout& layout = placed.layout;
  setup::warn_of_frequency(layout, options.medium);
  array::Schedule schedule = o.touch.empty() ? schedule_of(o.foci, layout) : slot_of_touch(o, played.schedule, placed);
  for (array::Voice& voice : schedule.voices) {
    if (voice.pressure_pa == 0) voice.pressure_pa = o.drive.pressure_pa.value_or(0);
  }
  std::vector<array::SlotFocus> foci;
  array::foci_of_slot(schedule, 0, foci);
  const array::DriveOptions in_free_air = options;
  const std::unique_ptr<ScatteringFinger> finger = finger_of(o, layout, options, foci);
  if (finger) options.transfer = &finger->sound;
  const std::vector<std::complex<double>> factors = factors_for(layout, schedule, options, o.touch);
  const array::Drive drive = finger || o.common.backend == setup::Backend::cpu
                                 ? drive_on_cpu(layout, foci, factors, options)
                                 : drive_on_gpu(setup::device_options(o.common), layout, foci, factors, options);

  const acoustics::FociPressure pressure =
      finger ? acoustics::pressure_at_foci(layout, drive, foci, finger->sound)
             : acoustics::pressure_at_foci(layout, drive, foci, options.medium, options.directivity);
  if (finger && factors.empty()) finger->gains = gains_over(in_free_air, layout, foci, *finger, pressure);
  const std::vector<array::FocusPair> unresolved = array::unresolved_pairs(layout, foci, options);

  if (!o.csv.empty()) write_file(o.csv, setup::drive_csv(layout, drive));
  if (!o.common.json.empty())
    write_file(o.common.json, to_json(layout, foci, options.medium, drive, pressure, unresolved, finger.get()));
  if (setup::shows_summary(o.common, outputs)) {
    const bool loud = *std::ranges::max_element(pressure.pascals) > array::linear_pressure_pa;
    write_file("-", summary(layout, foci, options.medium, drive, pressure, unresolved, finger.get()) +
                        (!factors.empty() && loud ? setup::linear_line() : ""));
  }
}

}  // namespace

void add_drive(Program& program) {
  add_subcommand<DriveCommand>(
      program,
      {"drive", "amplitude and phase of every transducer for one focus or several at once",
       "  palpa drive --layout openmpd --focus 0,0,150mm --csv drive.csv\n"
       "  palpa drive --layout paper --focus 0,0,0 --focus 20mm,0,0,0.5 --solver gs-pat --json -\n"
       "  palpa drive --layout paper --touch touch.json --slot 3 --csv drive.csv\n"
       "  palpa drive --layout paper --focus 0,0.2mm,0 --transfer finger --mesh assets/finger.ply\n"
       "Phases are delays in radians (time factor e^-iwt), amplitudes lie in 0..1."},
      add_options, run);
}

}  // namespace palpa::cli
