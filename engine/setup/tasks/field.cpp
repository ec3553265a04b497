#include "setup/tasks/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "acoustics/field/field_pass.hpp"
#include "acoustics/field/incident.hpp"
#include "array/layouts/as_built.hpp"
#include "array/layouts/layout.hpp"
#include "array/loudness.hpp"
#include "array/schedule.hpp"
#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/files/json_rows.hpp"
#include "base/files/json_writer.hpp"
#include "base/system/memory.hpp"
#include "setup/files/drive_file.hpp"
#include "setup/options/nulls.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/touch_run.hpp"
#include "setup/tasks/foci.hpp"

namespace palpa::setup {
namespace {

/// The drive of the file, or one that is made for the foci. The foci are then added to `result`.
array::Drive drive_of(const FieldTask& task, const array::Layout& layout, FieldResult& result) {
  if (!task.drive_file.empty()) return load_drive(task.drive_file, layout);
  array::DriveOptions options = drive_options(task.drive, layout, Solving::once);
  array::Schedule schedule = schedule_of(task.foci, layout);
  prepare_nulls(task.drive, layout, options);
  for (array::Voice& voice : schedule.voices)
    voice.pressure_pa = task.drive.pressure_pa;
  array::foci_of_slot(schedule, 0, result.foci);
  check_nulls(layout, result.foci, options);
  result.by = array::driven_by(options, layout.transducers.size(), array::Loudness::asked(schedule));
  array::Drive drive = drive_on_cpu(layout, result.foci, factors_for(layout, schedule, options), options);
  warn_of_nulls(report_nulls(layout, drive, result.foci, options));
  return drive;
}

std::size_t loudest_of(std::span<const std::complex<double>> pressures) {
  const auto norm = [](const std::complex<double>& pressure) { return std::norm(pressure); };
  return static_cast<std::size_t>(std::ranges::max_element(pressures, {}, norm) - pressures.begin());
}

/// Computes the field at the places of `result`, in its air.
void sum(const array::Layout& layout, std::span<const array::TransducerDrive> drive, array::Directivity directivity,
         const gpu::Device* device, FieldResult& result) {
  const acoustics::Strengths strengths = acoustics::strengths_of(drive);
  Stopwatch watch;
  if (device) {
    acoustics::field_on(*device, layout, result.air, directivity, result.places.points, strengths, result.pressures);
  } else {
    acoustics::Waves waves;
    acoustics::Incident(layout, result.air, directivity).at(result.places.points, {}, strengths, waves);
    result.pressures = std::move(waves.pressures);
  }
  result.sum_ms = watch.lap_ms();
  result.loudest = loudest_of(result.pressures);
}

}  // namespace

void check(const FieldTask& task, bool picture) {
  if (task.layout.empty())
    throw bad_usage(fmt::format("--layout is missing: give {} or a layout TOML", array::known_layouts()));
  if (task.drive_file.empty() == task.foci.empty()) {
    throw bad_usage(task.foci.empty() ? "nothing sounds: give --drive FILE.csv, or --focus x,y,z such as 0,0,150mm"
                                      : "--drive and --focus exclude each other: give one of them");
  }
  if (picture && task.place.given() && !task.place.plane && task.place.line[0].empty())
    throw bad_usage("--png draws a plane or a line: give --plane or --line, or use --csv or --vtu");
  check(task.place);
  check(task.spread, task.drive.medium);
  check_pressure(task.drive.pressure_pa);
}

bool FieldResult::beyond_linear() const {
  return peak_pa() > array::linear_pressure_pa;
}

const JsonRows<FieldResult>& field_rows() {
  using Result = FieldResult;
  static const auto spread = spread_rows<FieldSpread>()
                                 .value("peak_pa", [](const FieldSpread& s) { return numbers_of(s.peak_pa); })
                                 .value("peak_m", [](const FieldSpread& s) { return lists_of(s.peak_m); });
  static const auto rows =
      JsonRows<Result>()
          .value("points", [](const Result& r) { return std::uint64_t{r.pressures.size()}; })
          .value("peak_pa", [](const Result& r) { return r.peak_pa(); })
          .value("peak_m", [](const Result& r) { return r.places.points[r.loudest]; })
          .value("sound_speed_m_s", [](const Result& r) { return r.air.medium.sound_speed; })
          .value("density_kg_m3", [](const Result& r) { return r.air.density_kg_m3; })
          .value("absorption_np_m", [](const Result& r) { return r.air.absorption_np_m; })
          .members(array::driven_rows(), [](const Result& r) { return r.by ? &*r.by : nullptr; })
          .object("spread", spread, [](const Result& r) { return r.spread ? &*r.spread : nullptr; })
          .written({}, [](JsonWriter& json, const Result& r) {
            json.key("timing_ms").begin_object().member("field", r.sum_ms).member("total", r.total_ms).end_object();
          });
  return rows;
}

std::string to_json(const FieldResult& result) {
  return field_rows().text(result);
}

FieldResult sum_field(const array::Layout& layout, std::span<const array::TransducerDrive> drive, Places places,
                      const acoustics::Air& air, array::Directivity directivity, const gpu::Device* device) {
  Stopwatch watch;
  check_drive(layout, drive);
  if (places.points.empty()) throw bad_usage("there are no points to look at");
  FieldResult result{.places = std::move(places), .pressures = {}, .air = air, .layout = layout.name, .foci = {}};
  sum(layout, drive, directivity, device, result);
  result.total_ms = watch.lap_ms();
  return result;
}

FieldSpread spread_of_field(const FieldTask& task, const array::Layout& layout, const array::Drive& drive,
                            std::span<const Vec3> points, const Draws& draws, const gpu::Device* device) {
  const array::Spread spread = parse_spread(task.spread.text);
  std::vector<float> amplitudes;  // of each point, draw by draw
  reserve_large(amplitudes, points.size() * draws.count);
  amplitudes.resize(points.size() * draws.count);
  std::vector<double> peaks(draws.count);
  std::array<std::vector<double>, 3> peaks_at;
  peaks_at.fill(peaks);
  std::optional<acoustics::FieldOn> on;
  if (device) on.emplace(*device, task.drive.directivity, air(task.drive.medium, task.air).absorption_np_m != 0);
  acoustics::Waves waves;
  Activity activity("computing random arrays", draws.count);
  for (std::uint32_t draw = 0; draw < draws.count; ++draw) {
    const array::AsBuilt built = array::as_built(layout, drive, spread, draws.seed, draw);
    const acoustics::Air warm = air(warmer(task.drive.medium, built.temperature), task.air);
    const acoustics::Strengths strengths = acoustics::strengths_of(built.drive);
    if (on) {
      on->at(built.layout, warm, points, strengths, waves.pressures);
    } else {
      acoustics::Incident(built.layout, warm, task.drive.directivity).at(points, {}, strengths, waves);
    }
    for (std::size_t i = 0; i < points.size(); ++i)
      amplitudes[i * draws.count + draw] = static_cast<float>(std::abs(waves.pressures[i]));
    const std::size_t loudest = loudest_of(waves.pressures);
    peaks[draw] = std::abs(waves.pressures[loudest]);
    for (int axis = 0; axis < 3; ++axis)
      peaks_at[static_cast<std::size_t>(axis)][draw] = points[loudest][axis];
    activity.advance();
  }
  FieldSpread result{.draws = draws, .peak_pa = percentiles(std::move(peaks)), .peak_m = {}, .amplitudes = {}};
  std::ranges::transform(peaks_at, result.peak_m.begin(),
                         [](const std::vector<double>& at) { return percentiles(at); });
  reserve_large(result.amplitudes, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto of_point = std::span(amplitudes).subspan(i * draws.count, draws.count);
    result.amplitudes.push_back(percentiles({of_point.begin(), of_point.end()}));
  }
  return result;
}

FieldResult sum_field(const FieldTask& task, const CommonOptions& common, const std::function<void()>& all_read) {
  Stopwatch watch;
  check(task);
  FieldResult result;
  result.air = air(task.drive.medium, task.air);
  const array::Layout layout = array::load_layout(task.layout);
  result.layout = layout.name;
  warn_of_frequency(layout, result.air.medium);
  result.places = load_places(task.place);
  const array::Drive drive = drive_of(task, layout, result);
  if (all_read) all_read();
  const UsedDevice device(common);
  sum(layout, drive, task.drive.directivity, device.get(), result);
  if (!task.spread.text.empty()) {
    result.spread =
        spread_of_field(task, layout, drive, result.places.points, draws_of(task.spread, common.seed), device.get());
  }
  result.total_ms = watch.lap_ms();
  return result;
}

}  // namespace palpa::setup
