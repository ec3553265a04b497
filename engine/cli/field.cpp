#include "setup/tasks/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <glm/geometric.hpp>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "array/field/directivity.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/system/memory.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "cli/commands.hpp"
#include "drawing/field_picture.hpp"
#include "drawing/line_picture.hpp"
#include "drawing/png.hpp"
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

// ---- the picture that --png draws of a plane or along a line

/// "3.2" for 3.2 mm, also for values that differ from it by nanometres.
std::string in_mm(double metres) {
  const double mm = std::round(metres * 1e9) / 1e6;
  return fmt::format("{:g}", mm == 0 ? 0 : mm);
}

std::string place_text(const Vec3& at) {
  return fmt::format("({}, {}, {})", in_mm(at.x), in_mm(at.y), in_mm(at.z));
}

std::string title_of(const setup::FieldResult& field, const setup::FieldTask& task) {
  const std::string name = printable(field.layout, 40);
  if (field.foci.empty()) return fmt::format("{}: {}", name, printable(shortened(task.drive_file, 40)));
  if (field.foci.size() > 1) return fmt::format("{}: {} foci", name, field.foci.size());
  return fmt::format("{}: focus at {} mm", name, place_text(field.foci[0].position));
}

/// Notes, top and unit of a picture's values. Above the pressure up to which linear acoustics holds, values are shown
/// relative to the largest.
template <typename Picture>
void set_values(Picture& picture, const setup::FieldResult& field, const std::string& place,
                const setup::FieldTask& task, double most_pa) {
  picture.title = "Sound pressure, " + title_of(field, task);
  picture.notes = {fmt::format(
      "{}; {}, {:g} kHz, {:.1f} m/s, {:.3f} Np/m", place, word_of(array::directivity_words, task.drive.directivity),
      field.air.medium.frequency / 1e3, field.air.medium.sound_speed, field.air.absorption_np_m)};
  picture.most = most_pa;
  picture.unit = "Pa, peak";
  if (!field.beyond_linear()) return;
  picture.notes.push_back(
      fmt::format("Beyond linear acoustics: the linear sum reaches {:.1f} kPa", field.peak_pa() / 1e3));
  picture.scale = 1 / field.peak_pa();
  picture.most = most_pa / field.peak_pa();
  picture.unit = "of the largest";
}

std::vector<double> sizes_of(const setup::FieldResult& field) {
  std::vector<double> sizes;
  reserve_large(sizes, field.pressures.size());
  sizes.resize(field.pressures.size());
  std::ranges::transform(field.pressures, sizes.begin(), [](const std::complex<double>& p) { return std::abs(p); });
  return sizes;
}

void draw_plane(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task) {
  const setup::Grid& grid = *field.places.grid;
  const std::vector<double> sizes = sizes_of(field);
  const std::string_view letters = word_of(setup::plane_words, grid.plane);
  const auto axis = [](char letter) { return letter - 'x'; };
  const int right = axis(letters[0]), up = axis(letters[1]), depth = 3 - right - up;

  drawing::FieldPicture picture;
  picture.values = sizes;
  picture.columns = grid.columns;
  picture.rows = grid.rows;
  const Vec2 centre(grid.centre[right], grid.centre[up]);
  picture.low_mm = (centre - grid.size_m * 0.5) * 1e3;
  picture.high_mm = (centre + grid.size_m * 0.5) * 1e3;
  picture.right = letters[0];
  picture.up = letters[1];
  set_values(picture, field, fmt::format("{} = {} mm", static_cast<char>('x' + depth), in_mm(grid.centre[depth])), task,
             field.peak_pa());
  drawing::write_png(file, drawing::draw(picture));
}

void draw_line(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task) {
  const Vec3 &from = field.places.points.front(), &to = field.places.points.back();
  const std::vector<double> sizes = sizes_of(field);
  std::vector<double> low, high;
  double most = field.peak_pa();
  if (field.spread) {
    for (const setup::Percentiles& range : field.spread->amplitudes) {
      low.push_back(range.p05);
      high.push_back(range.p95);
      most = std::max(most, range.p95);
    }
  }
  drawing::LinePicture picture;
  picture.values = sizes;
  picture.low = low;
  picture.high = high;
  picture.length_mm = glm::distance(from, to) * 1e3;
  picture.along = fmt::format("distance from {}", place_text(from));
  // A little room above the curve.
  set_values(picture, field, fmt::format("from {} to {} mm", place_text(from), place_text(to)), task, 1.04 * most);
  if (field.spread) {
    const setup::Draws& draws = field.spread->draws;
    picture.notes.push_back(fmt::format("Band: 90 % of {} random arrays, --spread {}", draws.count, task.spread.text));
  }
  drawing::write_png(file, drawing::draw(picture));
}

/// Draws |p| of `field`, which was computed from `task` on a plane or a line, into the PNG `file`: colours with a bar
/// in Pa, or a curve, with a band if there is a spread; axes in mm. Above the pressure up to which linear acoustics
/// holds, the picture shows only values relative to the largest. Throws failure() if the file cannot be written.
void draw_field(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task) {
  if (field.places.grid) return draw_plane(file, field, task);
  draw_line(file, field, task);
}

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
