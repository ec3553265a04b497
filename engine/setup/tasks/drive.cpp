#include "setup/tasks/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <complex>
#include <glm/matrix.hpp>
#include <ranges>
#include <string_view>
#include <utility>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_mesh.hpp"
#include "array/drive.hpp"
#include "array/drive_pass.hpp"
#include "array/layouts/layout.hpp"
#include "array/nulls/nulls.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/files/json_rows.hpp"
#include "base/files/json_writer.hpp"
#include "base/system/parallel.hpp"
#include "gpu/commands.hpp"
#include "setup/files/body.hpp"
#include "setup/files/pattern_file.hpp"
#include "setup/files/touch_file.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/load.hpp"
#include "touch/methods/method.hpp"

namespace palpa::setup {
namespace {

/// Without absorption, as in the solvers.
acoustics::Air air_of_solvers(const FocusingOptions& drive) {
  return acoustics::without_absorption(air(drive.medium, {}));
}

/// The sound in the touch's slot, in the layout's frame, as a schedule of one slot: one voice per finger, except for
/// silent fingers (`gain` 0).
array::Schedule slot_of_touch(const DriveTask& task, const array::Schedule& touch, const PlacedLayout& placed) {
  constexpr std::uint64_t longest_cycle = 1u << 20;
  const std::uint32_t slot = task.slot.value_or(0);
  if (const std::uint64_t cycle = array::cycle_length(touch, longest_cycle); cycle != 0 && slot >= cycle) {
    throw bad_usage(fmt::format("--slot: {} does not exist: {} has {}", slot, task.touch,
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
                fmt::format("{}: the focus of finger {}", task.touch, finger.id));
  }
  if (schedule.voice_count == 0) throw bad_input(task.touch, "every finger of this touch is silent: its gain is 0");
  return schedule;
}

/// Refuses fingers that request a pressure together with options that a pressure replaces.
void check_pressures(const DriveTask& task, const array::Schedule& touch) {
  for (const array::Voice& finger : touch.voices) {
    if (finger.pressure_pa)
      refuse_beside_pressure(task.drive, fmt::format("finger {} of {} asks for a pressure", finger.id, task.touch));
  }
}

/// Sets the pressure for each voice that does not request one itself.
void ask_for_pressure(const FocusingOptions& drive, array::Schedule& schedule) {
  for (array::Voice& voice : schedule.voices) {
    if (!voice.pressure_pa) voice.pressure_pa = drive.pressure_pa;
  }
}

array::Drive drive_on_gpu(const gpu::Device& device, const array::Layout& layout,
                          std::span<const array::SlotFocus> foci, std::span<const std::complex<double>> factors,
                          const array::DriveOptions& options) {
  const array::DrivePasses passes(device, factors.empty() ? options.solver : array::Solver::naive);
  array::DriveMemory buffers(device, layout, options, 1, static_cast<std::uint32_t>(foci.size()));
  const bool fits = factors.empty() ? buffers.add_slot(foci) : buffers.add_slot(foci, factors);
  if (!fits) throw failure("more foci than the GPU's buffers hold");
  const gpu::Recorder recorder(device, "drive");
  gpu::Timeline timeline(device);
  array::compute_drives(buffers, passes, recorder, timeline);
  const auto drive = buffers.drive(0);
  return {drive.begin(), drive.end()};
}

std::vector<Vec3> aim(BodyInSound& finger, const std::vector<array::SlotFocus>& foci) {
  std::vector<Vec3> places;
  places.reserve(foci.size());
  for (const array::SlotFocus& focus : foci)
    places.push_back(focus.position);
  return finger.sound.aim(places);
}

/// The gain at each focus relative to the drive for free air.
std::vector<double> gains_over(const array::DriveOptions& in_free_air, const array::Layout& layout,
                               const BodyInSound& finger, const DriveResult& result) {
  const array::Drive other = array::drive_for(layout, result.foci, in_free_air);
  const acoustics::FociPressure before = acoustics::pressure_at_foci(layout, other, result.foci, finger.sound);
  std::vector<double> gains;
  gains.reserve(result.foci.size());
  for (std::size_t j = 0; j < result.foci.size(); ++j)
    gains.push_back(before.pascals[j] > 0 ? result.pressure.pascals[j] / before.pascals[j] : 0);
  return gains;
}

/// The place where drives are computed.
struct Computer {
  const gpu::Device* device = nullptr;      ///< an open device,
  const ComputeOptions* options = nullptr;  ///< or these options give it; neither: the processor
  BodyInSound* finger = nullptr;            ///< on the processor; its transfer replaces free air
  std::string touch;                        ///< file of the foci, for messages
};

array::Drive drive_by(const Computer& by, const array::Layout& layout, std::span<const array::SlotFocus> foci,
                      std::span<const std::complex<double>> factors, const array::DriveOptions& options) {
  if (by.finger || !(by.device || by.options)) return drive_on_cpu(layout, foci, factors, options);
  if (by.device) return drive_on_gpu(*by.device, layout, foci, factors, options);
  const UsedDevice device(*by.options);
  return drive_on_gpu(*device.get(), layout, foci, factors, options);
}

/// A pattern's points become foci. Its silent places, and the solver that it needs, go into `drive`.
std::vector<AskedFocus> foci_of_pattern(const std::string& name, FocusingOptions& drive) {
  const Pattern pattern = load_pattern(name);
  std::vector<AskedFocus> foci;
  for (const auto& [position, amplitude] : pattern.points)
    foci.push_back({position, amplitude});
  drive.nulls.insert(drive.nulls.end(), pattern.nulls.begin(), pattern.nulls.end());
  drive.nulls_from = "--pattern " + name;
  return foci;
}

/// Computes the drive of slot 0 of the schedule. If there is a finger, it must already be aimed at the schedule's foci.
void drive_slot(const array::Layout& layout, array::Schedule& schedule, const array::DriveOptions& in_free_air,
                const Computer& by, DriveResult& result) {
  array::DriveOptions options = in_free_air;
  check_nulls(layout, result.foci, options);
  if (by.finger) options.transfer = &by.finger->sound;
  const std::vector<std::complex<double>> factors = factors_for(layout, schedule, options, by.touch);
  result.layout = layout;
  result.medium = options.medium;
  result.pressure_asked = !factors.empty();
  result.by = array::driven_by(options, layout.transducers.size(), result.pressure_asked);
  result.drive = drive_by(by, layout, result.foci, factors, options);
  result.pressure =
      by.finger ? acoustics::pressure_at_foci(layout, result.drive, result.foci, by.finger->sound)
                : acoustics::pressure_at_foci(layout, result.drive, result.foci, options.medium, options.directivity);
  if (by.finger && factors.empty()) result.over_free_field = gains_over(in_free_air, layout, *by.finger, result);
  if (by.finger) result.effort = by.finger->body.effort();
  result.unresolved = array::unresolved_pairs(layout, result.foci, options);
  if (options.nulls) {
    result.nulls = report_nulls(layout, result.drive, result.foci, options);
    warn_of_nulls(*result.nulls);
  }
}

/// Refuses values that the command line refuses during parsing.
void check_values(const FocusingOptions& drive) {
  air_of_solvers(drive);  // refuses invalid air and tones
  check_pressure(drive.pressure_pa);
}

DriveResult drive_foci(const array::Layout& layout, std::span<const AskedFocus> foci, const FocusingOptions& drive,
                       const Computer& by) {
  if (foci.empty()) throw bad_usage("no focus is given");
  if (layout.transducers.empty()) throw bad_usage(fmt::format("the layout {} has no transducers", layout.name));
  if (by.finger && by.finger->transducers != layout.transducers.size()) {
    throw bad_usage(fmt::format("the finger was made for a layout of {} transducers, but {} has {}",
                                by.finger->transducers, layout.name, layout.transducers.size()));
  }
  check_values(drive);
  array::DriveOptions options =
      drive_options(drive, layout, Solving::once, by.finger ? FingerMesh::known : FingerMesh::unknown);
  warn_of_frequency(layout, options.medium);
  prepare_nulls(drive, layout, options);
  array::Schedule schedule = schedule_of(foci, layout);
  ask_for_pressure(drive, schedule);
  DriveResult result;
  array::foci_of_slot(schedule, 0, result.foci);
  if (by.finger) result.aimed = aim(*by.finger, result.foci);
  drive_slot(layout, schedule, options, by, result);
  return result;
}

}  // namespace

void check(const DriveTask& task) {
  check_values(task.drive);
  check(task.spread, task.drive.medium);
  const std::string asks = asks_for_finger(task.drive);
  if (!asks.empty() && task.mesh.empty())
    throw bad_usage(asks + ": --mesh is missing: give the finger's closed mesh, in the layout's frame");
  if (asks.empty() && (!task.mesh.empty() || task.force))
    throw bad_usage(fmt::format("{} goes with --transfer finger", task.mesh.empty() ? "--force" : "--mesh"));
  if (!asks.empty() && !task.spread.text.empty())
    throw bad_usage("--spread computes in free air and --transfer finger on a finger: give one of them");
  if (task.touch.empty()) {
    if (task.layout.empty() && !task.placed)
      throw bad_usage(fmt::format("--layout is missing: give {} or a layout TOML", array::known_layouts()));
    if (task.foci.empty() && task.pattern.empty()) {
      throw bad_usage(
          "--focus is missing: give a point x,y,z in the layout's frame, such as 0,0,150mm, or a --touch FILE or a "
          "--pattern FILE");
    }
    return;
  }
  if (!task.foci.empty()) throw bad_usage("--focus and --touch exclude each other: give one of them");
  if (task.layout.empty() && task.rig.empty() && !task.placed)
    throw bad_usage("--touch needs an array: give --layout, or the --rig that it stands in");
}

bool DriveResult::beyond_linear() const {
  return std::ranges::any_of(pressure.pascals, [](double pascals) { return pascals > array::linear_pressure_pa; });
}

const JsonRows<DriveResult>& drive_rows() {
  using Result = DriveResult;
  static const auto nulls = JsonRows<SilentPlace>()
                                .value("place_m", [](const SilentPlace& p) { return p.null.position; })
                                .value("radius_m", [](const SilentPlace& p) { return p.null.radius_m; })
                                .value("loudest_pa", [](const SilentPlace& p) { return p.loudest_pa; })
                                .value("depth_db", [](const SilentPlace& p) { return p.depth_db; });
  static const auto spread =
      spread_rows<DriveSpread>()
          .value("pressures_pa", [](const DriveSpread& s) { return lists_of(s.pressures_pa); })
          .value("weakest_to_strongest", [](const DriveSpread& s) { return numbers_of(s.evenness); })
          .value("nulls_pa", [](const DriveSpread& s) {
            return s.nulls_pa.empty() ? std::nullopt : std::optional(lists_of(s.nulls_pa));
          });
  static const auto rows =
      JsonRows<Result>()
          .value("layout", [](const Result& r) { return std::string_view(r.layout.name); })
          .value("transducers", [](const Result& r) { return std::uint64_t{r.drive.size()}; })
          .value("sound_speed_m_s", [](const Result& r) { return r.medium.sound_speed; })
          .value("frequency_hz", [](const Result& r) { return r.medium.frequency; })
          .members(array::driven_rows(), [](const Result& r) { return r.by; })
          .value("foci_m", [](const Result& r) { return std::views::transform(r.foci, &array::SlotFocus::position); })
          .value("aimed_m", [](const Result& r) { return r.aimed.empty() ? nullptr : &r.aimed; })
          .object(
              "solution", solution_rows(), [](const Result& r) { return r.effort.iterates ? &r.effort : nullptr; },
              JsonWriter::Style::line)
          .value("gains", [](const Result& r) { return std::views::transform(r.foci, &array::SlotFocus::gain); })
          .value("pressures_pa", [](const Result& r) { return std::span(r.pressure.pascals); })
          .value("weakest_to_strongest", [](const Result& r) { return r.pressure.evenness; })
          .value("over_free_field",
                 [](const Result& r) { return r.over_free_field.empty() ? nullptr : &r.over_free_field; })
          .objects("nulls", nulls, [](const Result& r) { return r.nulls ? &r.nulls->places : nullptr; })
          .value("kept_with_nulls", [](const Result& r) { return r.nulls ? &r.nulls->kept : nullptr; })
          .value("unresolved_pairs",
                 [](const Result& r) {
                   return std::views::transform(r.unresolved, [](const array::FocusPair& pair) {
                     return std::array{std::uint64_t{pair.first}, std::uint64_t{pair.second}};
                   });
                 })
          .value("amplitudes",
                 [](const Result& r) { return std::views::transform(r.drive, &array::TransducerDrive::amplitude); })
          .value("phases_rad",
                 [](const Result& r) { return std::views::transform(r.drive, &array::TransducerDrive::phase); })
          .object("spread", spread, [](const Result& r) { return r.spread ? &*r.spread : nullptr; });
  return rows;
}

std::string to_json(const DriveResult& result) {
  return drive_rows().text(result);
}

DriveSpread spread_of_drive(const array::Layout& layout, const array::Drive& drive,
                            std::span<const array::SlotFocus> foci, const MediumOptions& medium_options,
                            array::Directivity directivity, const array::Spread& spread, const Draws& draws) {
  std::vector<std::vector<double>> pascals(foci.size(), std::vector<double>(draws.count));
  std::vector<double> evenness(draws.count);
  parallel_chunks(draws.count, 1, [&](std::size_t draw, std::size_t, std::size_t) {
    const array::AsBuilt built = array::as_built(layout, drive, spread, draws.seed, static_cast<std::uint32_t>(draw));
    const acoustics::FociPressure pressure = acoustics::pressure_at_foci(
        built.layout, built.drive, foci, medium(warmer(medium_options, built.temperature)), directivity);
    for (std::size_t j = 0; j < foci.size(); ++j)
      pascals[j][draw] = pressure.pascals[j];
    evenness[draw] = pressure.evenness;
  });
  DriveSpread result{.draws = draws, .pressures_pa = {}, .evenness = percentiles(std::move(evenness))};
  result.pressures_pa.reserve(foci.size());
  for (std::vector<double>& of_focus : pascals)
    result.pressures_pa.push_back(percentiles(std::move(of_focus)));
  return result;
}

DriveSpread spread_of_drive(const DriveResult& result, const MediumOptions& medium, array::Directivity directivity,
                            const array::Spread& spread, const Draws& draws) {
  const auto at = [&](std::span<const array::SlotFocus> places) {
    return spread_of_drive(result.layout, result.drive, places, medium, directivity, spread, draws);
  };
  DriveSpread ranges = at(result.foci);
  if (!result.nulls) return ranges;
  std::vector<array::SlotFocus> centres;
  for (const SilentPlace& place : result.nulls->places)
    centres.push_back({place.null.position});
  ranges.nulls_pa = at(centres).pressures_pa;  // the same arrays: the seed is the same
  return ranges;
}

BodyInSound::BodyInSound(geometry::Mesh mesh, const array::Layout& layout, const FocusingOptions& drive)
    : body(std::move(mesh), air_of_solvers(drive).wave_number()),
      sound(body, layout, air_of_solvers(drive), drive.directivity),
      transducers(layout.transducers.size()) {}

std::unique_ptr<BodyInSound> finger_in_sound(const std::string& name, const geometry::Mesh& mesh,
                                             const array::Layout& layout, const FocusingOptions& drive, bool force) {
  geometry::Mesh body = body_of(name, mesh, air_of_solvers(drive), force);
  acoustics::check_clear_of(name, body, layout);
  return std::make_unique<BodyInSound>(std::move(body), layout, drive);
}

DriveResult make_drive(const array::Layout& layout, std::span<const AskedFocus> foci, const FocusingOptions& drive,
                       const gpu::Device* device) {
  return drive_foci(layout, foci, drive, {.device = device});
}

DriveResult make_drive(const array::Layout& layout, std::span<const AskedFocus> foci, const FocusingOptions& drive,
                       BodyInSound& finger) {
  return drive_foci(layout, foci, drive, {.finger = &finger});
}

DriveResult make_drive(const DriveTask& task, const CommonOptions& common, const std::function<void()>& finger_read) {
  check(task);
  PlayedTouch played;
  if (!task.touch.empty()) played = task.touch_json ? read_touch(task.touch, *task.touch_json) : load_touch(task.touch);
  FocusingOptions drive = task.drive;
  std::vector<AskedFocus> pattern;
  if (!task.pattern.empty()) pattern = foci_of_pattern(task.pattern, drive);
  const FingerMesh mesh = task.mesh.empty() ? FingerMesh::unknown : FingerMesh::known;
  check(drive, mesh);
  check_pressures(task, played.schedule);
  const PlacedLayout placed = task.placed ? *task.placed : load_placed_layout({.rig = task.rig, .layout = task.layout});
  const array::Layout& layout = placed.layout;
  array::DriveOptions options = drive_options(drive, layout, Solving::once, mesh);
  warn_of_frequency(layout, options.medium);
  prepare_nulls(drive, layout, options);
  array::Schedule schedule = !task.pattern.empty() ? schedule_of(pattern, layout)
                             : task.touch.empty()  ? schedule_of(task.foci, layout)
                                                   : slot_of_touch(task, played.schedule, placed);
  ask_for_pressure(task.drive, schedule);
  DriveResult result;
  array::foci_of_slot(schedule, 0, result.foci);
  std::unique_ptr<BodyInSound> finger;
  if (!task.mesh.empty()) {
    geometry::Mesh body = load_body(task.mesh, air_of_solvers(task.drive), task.force);
    acoustics::check_clear_of(task.mesh, body, layout);
    if (finger_read) finger_read();
    finger = std::make_unique<BodyInSound>(std::move(body), layout, task.drive);
    result.aimed = aim(*finger, result.foci);
  }
  drive_slot(layout, schedule, options,
             {.options = on_gpu(common) ? &common : nullptr, .finger = finger.get(), .touch = task.touch}, result);
  if (!task.spread.text.empty()) {
    result.spread = spread_of_drive(result, task.drive.medium, options.directivity, parse_spread(task.spread.text),
                                    draws_of(task.spread, common.seed));
  }
  return result;
}

}  // namespace palpa::setup
