#include "setup/tasks/field.hpp"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <utility>

#include "acoustics/field/field_pass.hpp"
#include "acoustics/field/incident.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "setup/drive_file.hpp"
#include "setup/tasks/foci.hpp"
#include "setup/warnings.hpp"

namespace palpa::setup {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// The drive of the file, or one that is made for the foci. The foci are then added to `result`.
array::Drive drive_of(const FieldTask& task, const array::Layout& layout, FieldResult& result) {
  if (!task.drive_file.empty()) return load_drive(task.drive_file, layout);
  const array::DriveOptions options = drive_options(task.drive);
  array::Schedule schedule = schedule_of(task.foci, layout);
  for (array::Voice& voice : schedule.voices)
    voice.pressure_pa = task.drive.pressure_pa.value_or(0);
  array::foci_of_slot(schedule, 0, result.foci);
  return drive_on_cpu(layout, result.foci, factors_for(layout, schedule, options), options);
}

/// Computes the field at the places of `result`, in its air.
void sum(const array::Layout& layout, std::span<const array::TransducerDrive> drive, array::Directivity directivity,
         const gpu::Device* device, FieldResult& result) {
  const acoustics::Strengths strengths = acoustics::strengths_of(drive);
  const auto begin = Clock::now();
  if (device) {
    acoustics::field_on(*device, layout, result.air, directivity, result.places.points, strengths, result.pressures);
  } else {
    acoustics::Waves waves;
    acoustics::Incident(layout, result.air, directivity).at(result.places.points, {}, strengths, waves);
    result.pressures = std::move(waves.pressures);
  }
  result.sum_ms = milliseconds_since(begin);
  for (std::size_t i = 0; i < result.pressures.size(); ++i) {
    if (std::norm(result.pressures[i]) > std::norm(result.pressures[result.loudest])) result.loudest = i;
  }
}

}  // namespace

void check(const FieldTask& task, bool picture) {
  if (task.layout.empty())
    throw bad_usage("--layout is missing: give autd3, paper, openmpd, openmpd-pair, sonicsurface or a layout TOML");
  if (task.drive_file.empty() == task.foci.empty()) {
    throw bad_usage(task.foci.empty() ? "nothing sounds: give --drive FILE.csv, or --focus x,y,z such as 0,0,150mm"
                                      : "--drive and --focus exclude each other: give one of them");
  }
  const DriveOptionsGroup usual;
  if (!task.drive_file.empty() && (task.drive.weighting != usual.weighting || task.drive.solver ||
                                   task.drive.transfer || task.drive.constraint || task.drive.pressure_pa)) {
    throw bad_usage(
        "--amplitude, --solver, --transfer, --constraint and --pressure go with --focus: --drive is already a drive");
  }
  if (picture && task.place.given() && !task.place.plane)
    throw bad_usage("--png draws a plane: give --plane, or use --csv or --vtu");
  refuse_idle_air(task.air);
  check_pressure(task.drive.pressure_pa);
}

bool FieldResult::beyond_linear() const {
  return peak_pa() > array::linear_pressure_pa;
}

std::string to_json(const FieldResult& result) {
  JsonWriter json;
  json.begin_object()
      .member("points", std::uint64_t{result.pressures.size()})
      .member("peak_pa", result.peak_pa())
      .member("peak_m", result.places.points[result.loudest])
      .member("sound_speed_m_s", result.air.medium.sound_speed)
      .member("density_kg_m3", result.air.density_kg_m3)
      .member("absorption_np_m", result.air.absorption_np_m);
  json.key("timing_ms").begin_object().member("field", result.sum_ms).member("total", result.total_ms).end_object();
  json.end_object();
  return json.take();
}

FieldResult sum_field(const array::Layout& layout, std::span<const array::TransducerDrive> drive, Places places,
                      const acoustics::Air& air, array::Directivity directivity, const gpu::Device* device) {
  const auto begin = Clock::now();
  check_drive(layout, drive);
  if (places.points.empty()) throw bad_usage("there are no points to look at");
  FieldResult result{.places = std::move(places), .pressures = {}, .air = air, .layout = layout.name, .foci = {}};
  sum(layout, drive, directivity, device, result);
  result.total_ms = milliseconds_since(begin);
  return result;
}

FieldResult sum_field(const FieldTask& task, const CommonOptions& common, const std::function<void()>& all_read) {
  const auto begin = Clock::now();
  check(task);
  FieldResult result;
  result.air = air(task.drive.medium, task.air);
  const array::Layout layout = array::load_layout(task.layout);
  result.layout = layout.name;
  warn_of_frequency(layout, result.air.medium);
  result.places = load_places(task.place);
  const array::Drive drive = drive_of(task, layout, result);
  if (all_read) all_read();
  std::optional<gpu::Device> device;
  if (common.backend == Backend::gpu) device.emplace(device_options(common));
  sum(layout, drive, task.drive.directivity, device ? &*device : nullptr, result);
  result.total_ms = milliseconds_since(begin);
  return result;
}

}  // namespace palpa::setup
