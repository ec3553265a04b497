#include "setup/tasks/field.hpp"

#include <fmt/format.h>

#include <complex>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/system/memory.hpp"
#include "cli/commands.hpp"
#include "cli/field_picture.hpp"
#include "geometry/files/vtu.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/options/nulls.hpp"
#include "setup/options/options.hpp"
#include "setup/options/places.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/touch_run.hpp"
#include "setup/tasks/foci.hpp"

namespace palpa::cli {
namespace {

struct FieldCommand {
  setup::CommonOptions common;
  setup::FieldTask task;
  std::string csv, vtu, png;
};

void add_options_of_field(CLI::App& app, FieldCommand& o) {
  const line::Group group(app, "What sounds");
  setup::add_layout(group, o.task.layout, "the array");
  group.text("--drive", o.task.drive_file, "FILE", "the array's drive, as palpa drive --csv writes it");
  group.texts("--focus", o.task.foci, "X,Y,Z[,A]", fmt::format("instead of --drive: {}", setup::focus_help),
              setup::check_focus_text);
  setup::add_null_option(group, o.task.drive, "the layout's own frame");
  setup::add_place_options(app, o.task.place);
  const line::Group results(app, "Results");
  results.text("--csv", o.csv, "FILE|-",
               "writes every point: x,y,z,re,im in metres and Pa; with --spread also p05,p50,p95 of |p|");
  results.text("--vtu", o.vtu, "FILE", "writes the same for ParaView, with amplitude and phase");
  results.text("--png", o.png, "FILE",
               "draws |p|: on a plane with a bar in Pa, along a line as a curve; axes are in mm");
  setup::add_drive_options(app, o.task.drive);
  setup::add_air_options(app, o.task.air);
  setup::add_spread_options(app, o.task.spread);
  line::exclude(app, "--drive", {"--amplitude", "--solver", "--constraint", "--pressure", "--null"});
  line::exclude(app, "--no-absorption", {"--air-pressure"});
}

/// Values computed in single precision are printed in single precision.
void write_csv(const std::string& file, const setup::FieldResult& field) {
  OutputFile out(file);
  std::string text = field.spread ? "x,y,z,re,im,p05,p50,p95\n" : "x,y,z,re,im\n";
  for (std::size_t i = 0; i < field.pressures.size(); ++i) {
    const Vec3& at = field.places.points[i];
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{}", at.x, at.y, at.z,
                   static_cast<float>(field.pressures[i].real()), static_cast<float>(field.pressures[i].imag()));
    if (field.spread) {
      const setup::Percentiles& range = field.spread->amplitudes[i];
      fmt::format_to(std::back_inserter(text), ",{},{},{}", static_cast<float>(range.p05),
                     static_cast<float>(range.p50), static_cast<float>(range.p95));
    }
    text += '\n';
    if (text.size() < (1u << 20)) continue;
    out.write(text);
    text.clear();
  }
  out.write(text);
  out.finish();
}

geometry::VtuCells cells_of(const setup::Places& places) {
  using Shape = geometry::VtuCells::Shape;
  const auto count = static_cast<std::uint32_t>(places.points.size());
  geometry::VtuCells cells;
  if (places.grid && places.grid->columns > 1 && places.grid->rows > 1) {
    cells.shape = Shape::quad;
    const std::uint32_t columns = places.grid->columns;
    for (std::uint32_t j = 0; j + 1 < places.grid->rows; ++j) {
      for (std::uint32_t i = j * columns; i + 1 < (j + 1) * columns; ++i)
        cells.corners.insert(cells.corners.end(), {i + columns, i + columns + 1, i + 1, i});
    }
  } else if (places.line) {
    cells.shape = Shape::line;
    for (std::uint32_t i = 0; i + 1 < count; ++i)
      cells.corners.insert(cells.corners.end(), {i, i + 1});
  } else if (!places.triangles.empty()) {
    cells.shape = Shape::triangle;
    for (const glm::uvec3& t : places.triangles)
      cells.corners.insert(cells.corners.end(), {t.x, t.y, t.z});
  } else {
    for (std::uint32_t i = 0; i < count; ++i)
      cells.corners.push_back(i);
  }
  return cells;
}

void write_vtu(const std::string& file, const setup::FieldResult& field) {
  std::vector<float> re, im, amplitude, phase;
  for (std::vector<float>* values : {&re, &im, &amplitude, &phase})
    reserve_large(*values, field.pressures.size());
  for (const std::complex<double>& p : field.pressures) {
    re.push_back(static_cast<float>(p.real()));
    im.push_back(static_cast<float>(p.imag()));
    amplitude.push_back(static_cast<float>(std::abs(p)));
    phase.push_back(static_cast<float>(std::arg(p)));
  }
  std::vector<geometry::VtuValues> values{
      {"amplitude (Pa)", amplitude}, {"phase (rad)", phase}, {"real part (Pa)", re}, {"imaginary part (Pa)", im}};
  std::vector<float> low, high;
  if (field.spread) {
    for (const setup::Percentiles& range : field.spread->amplitudes) {
      low.push_back(static_cast<float>(range.p05));
      high.push_back(static_cast<float>(range.p95));
    }
    values.push_back({"amplitude, 5 % of arrays below (Pa)", low});
    values.push_back({"amplitude, 95 % of arrays below (Pa)", high});
  }
  geometry::write_vtu(file, field.places.points, cells_of(field.places), values);
}

std::string summary_of_field(const setup::FieldResult& field) {
  const Vec3 at = field.places.points[field.loudest] * 1e3;
  const acoustics::Air& air = field.air;
  std::string text = fmt::format("{} points in {:.2f} s: at most {:.0f} Pa, at ({:.2f}, {:.2f}, {:.2f}) mm\n",
                                 field.pressures.size(), field.sum_ms / 1e3, field.peak_pa(), at.x, at.y, at.z);
  if (field.spread) {
    const auto& where = field.spread->peak_m;
    const auto in_mm = [](const setup::Percentiles& p) {
      return setup::range_text({p.p05 * 1e3, p.p50 * 1e3, p.p95 * 1e3}, 2);
    };
    fmt::format_to(std::back_inserter(text), "  {} Pa as built, at x {}, y {}, z {} mm\n",
                   range_text(field.spread->peak_pa, 0), in_mm(where[0]), in_mm(where[1]), in_mm(where[2]));
    text += spread_line(field.spread->draws);
  }
  fmt::format_to(std::back_inserter(text), "air: {:.2f} m/s, {:.4f} kg/m3, absorbs {:.4f} Np/m\n",
                 air.medium.sound_speed, air.density_kg_m3, air.absorption_np_m);
  return text + (field.beyond_linear() ? setup::linear_line() : "");
}

void run_field(const FieldCommand& o) {
  setup::Stopwatch watch;
  check(o.task, !o.png.empty());
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}, {"--vtu", o.vtu}, {"--png", o.png}});
  std::optional<setup::Preparing> progress;
  setup::FieldResult field = sum_field(o.task, o.common, [&] {
    log::release_warnings();
    progress.emplace(o.common.quiet);
  });
  progress.reset();

  if (!o.csv.empty()) write_csv(o.csv, field);
  if (!o.vtu.empty()) write_vtu(o.vtu, field);
  if (!o.png.empty()) draw_field(o.png, field, o.task);
  field.total_ms = watch.lap_ms();
  if (!o.common.json.empty()) write_file(o.common.json, to_json(field));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_field(field));
}

}  // namespace

void add_field(Program& program) {
  add_subcommand<FieldCommand>(
      program,
      {"field", "the sound field of an array on a plane, along a line or at points",
       "  palpa field --layout openmpd --focus 0,0,15cm --plane xz --centre 0,0,12cm --size 12cm,16cm \\\n"
       "              --png field.png\n"
       "  palpa field --layout openmpd --drive drive.csv --line 0,0,10cm 0,0,20cm --csv -",
       "--layout --drive --focus --plane --centre --size --line --points --csv --png",
       "Coordinates are in the layout's own frame. Pressures are peak values in free air, without a finger in the "
       "way (time factor e^-iwt)."},
      add_options_of_field, run_field);
}

}  // namespace palpa::cli
