#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field/field_pass.hpp"
#include "acoustics/field/incident.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"
#include "array/usual.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/memory.hpp"
#include "base/output_file.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "cli/commands.hpp"
#include "cli/foci_drive.hpp"
#include "drawing/field_picture.hpp"
#include "drawing/png.hpp"
#include "geometry/files/vtu.hpp"
#include "gpu/device.hpp"
#include "setup/drive_file.hpp"
#include "setup/options.hpp"
#include "setup/places.hpp"
#include "setup/progress.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct FieldCommand {
  setup::CommonOptions common;
  std::string layout, drive_file;
  std::vector<std::string> foci;
  setup::PlaceOptions place;
  std::string csv, vtu, png;
  setup::DriveOptionsGroup drive;
  setup::AirOptions air;
};

void add_options(CLI::App& app, FieldCommand& o) {
  const setup::Group group(app, "What sounds");
  group.text("--layout", o.layout, "NAME|FILE", "autd3, paper, openmpd, openmpd-pair, sonicsurface or a layout TOML");
  group.text("--drive", o.drive_file, "FILE", "the drive of that layout, as palpa drive --csv writes it");
  group.texts("--focus", o.foci, "X,Y,Z[,A]", fmt::format("in place of --drive: {}", focus_help));
  setup::add_place_options(app, o.place);
  const setup::Group results(app, "Results");
  results.text("--csv", o.csv, "FILE|-", "x,y,z,re,im of every point: metres, Pa");
  results.text("--vtu", o.vtu, "FILE", "the same for ParaView, with amplitude and phase");
  results.text("--png", o.png, "FILE", "a picture of the plane: |p|, a bar in Pa, axes in mm");
  setup::add_drive_options(app, o.drive);
  setup::add_air_options(app, o.air);
}

void check(const FieldCommand& o) {
  if (o.layout.empty())
    throw bad_usage("--layout is missing: give autd3, paper, openmpd, openmpd-pair, sonicsurface or a layout TOML");
  if (o.drive_file.empty() == o.foci.empty()) {
    throw bad_usage(o.foci.empty() ? "nothing sounds: give --drive FILE.csv, or --focus x,y,z such as 0,0,150mm"
                                   : "--drive and --focus exclude each other: give one of them");
  }
  const setup::DriveOptionsGroup usual;
  if (!o.drive_file.empty() && (o.drive.weighting != usual.weighting || o.drive.solver || o.drive.transfer ||
                                o.drive.constraint || o.drive.pressure_pa)) {
    throw bad_usage(
        "--amplitude, --solver, --transfer, --constraint and --pressure make a drive of --focus: --drive has one");
  }
  if (!o.png.empty() && o.place.given() && !o.place.plane)
    throw bad_usage("--png draws a plane: give --plane, or take --csv or --vtu");
  setup::refuse_idle_air(o.air);
}

struct Sound {
  array::Drive drive;
  std::vector<array::SlotFocus> foci;  ///< that it was made for; none of a file
};

Sound sound_of(const FieldCommand& o, const array::Layout& layout) {
  if (!o.drive_file.empty()) return {setup::load_drive(o.drive_file, layout), {}};
  const array::DriveOptions options = setup::drive_options(o.drive);
  array::Schedule schedule = schedule_of(o.foci, layout);
  for (array::Voice& voice : schedule.voices)
    voice.pressure_pa = o.drive.pressure_pa.value_or(0);
  Sound sound;
  array::foci_of_slot(schedule, 0, sound.foci);
  sound.drive = drive_on_cpu(layout, sound.foci, factors_for(layout, schedule, options), options);
  return sound;
}

struct Field {
  setup::Places places;
  std::vector<std::complex<double>> pressures;
  std::size_t loudest = 0;
  double sum_ms = 0;

  double peak_pa() const { return std::abs(pressures[loudest]); }
};

double milliseconds_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

void sum(const FieldCommand& o, const array::Layout& layout, const acoustics::Air& air, const array::Drive& drive,
         Field& field) {
  const acoustics::Strengths strengths = acoustics::strengths_of(drive);
  if (o.common.backend == setup::Backend::cpu) {
    const auto begin = Clock::now();
    acoustics::Waves waves;
    acoustics::Incident(layout, air, o.drive.directivity).at(field.places.points, {}, strengths, waves);
    field.pressures = std::move(waves.pressures);
    field.sum_ms = milliseconds_since(begin);
  } else {
    const gpu::Device device(setup::device_options(o.common));
    const auto begin = Clock::now();
    acoustics::field_on(device, layout, air, o.drive.directivity, field.places.points, strengths, field.pressures);
    field.sum_ms = milliseconds_since(begin);
  }
  for (std::size_t i = 0; i < field.pressures.size(); ++i) {
    if (std::norm(field.pressures[i]) > std::norm(field.pressures[field.loudest])) field.loudest = i;
  }
}

/// What is computed in single precision is printed as such.
void write_csv(const std::string& file, const Field& field) {
  OutputFile out(file);
  std::string text = "x,y,z,re,im\n";
  for (std::size_t i = 0; i < field.pressures.size(); ++i) {
    const Vec3& at = field.places.points[i];
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", at.x, at.y, at.z,
                   static_cast<float>(field.pressures[i].real()), static_cast<float>(field.pressures[i].imag()));
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

void write_vtu(const std::string& file, const Field& field) {
  std::vector<float> re, im, amplitude, phase;
  for (std::vector<float>* values : {&re, &im, &amplitude, &phase})
    reserve_large(*values, field.pressures.size());
  for (const std::complex<double>& p : field.pressures) {
    re.push_back(static_cast<float>(p.real()));
    im.push_back(static_cast<float>(p.imag()));
    amplitude.push_back(static_cast<float>(std::abs(p)));
    phase.push_back(static_cast<float>(std::arg(p)));
  }
  const geometry::VtuValues values[]{
      {"amplitude (Pa)", amplitude}, {"phase (rad)", phase}, {"real part (Pa)", re}, {"imaginary part (Pa)", im}};
  geometry::write_vtu(file, field.places.points, cells_of(field.places), values);
}

/// "3.2" for 3.2 mm; what differs from it by nanometres is it.
std::string in_mm(double metres) {
  const double mm = std::round(metres * 1e9) / 1e6;
  return fmt::format("{:g}", mm == 0 ? 0 : mm);
}

std::string title_of(const FieldCommand& o, const array::Layout& layout, const Sound& sound) {
  const std::string name = printable(layout.name, 40);
  if (sound.foci.empty()) return fmt::format("{}: {}", name, printable(shortened(o.drive_file, 40)));
  if (sound.foci.size() > 1) return fmt::format("{}: {} foci", name, sound.foci.size());
  const Vec3& at = sound.foci[0].position;
  return fmt::format("{}: focus at ({}, {}, {}) mm", name, in_mm(at.x), in_mm(at.y), in_mm(at.z));
}

/// Above the pressure to which linear acoustics holds, colours say no more than what is how large beside the largest.
void draw_png(const FieldCommand& o, const std::string& title, const acoustics::Air& air, const Field& field) {
  const setup::Grid& grid = *field.places.grid;
  std::vector<double> sizes;
  reserve_large(sizes, field.pressures.size());
  sizes.resize(field.pressures.size());
  std::ranges::transform(field.pressures, sizes.begin(), [](const std::complex<double>& p) { return std::abs(p); });
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
  picture.title = "Sound pressure, " + title;
  picture.notes = {fmt::format("{} = {} mm; {}, {:g} kHz, {:.1f} m/s, {:.3f} Np/m", static_cast<char>('x' + depth),
                               in_mm(grid.centre[depth]), word_of(array::directivity_words, o.drive.directivity),
                               air.medium.frequency / 1e3, air.medium.sound_speed, air.absorption_np_m)};
  if (field.peak_pa() > array::linear_pressure_pa) {
    picture.notes.push_back(
        fmt::format("Beyond linear acoustics: the linear sum reaches {:.1f} kPa", field.peak_pa() / 1e3));
    picture.scale = 1 / field.peak_pa();
    picture.most = 1;
    picture.unit = "of the largest";
  } else {
    picture.most = field.peak_pa();
    picture.unit = "Pa, peak";
  }
  drawing::write_png(o.png, drawing::draw(picture));
}

std::string to_json(const Field& field, const acoustics::Air& air, double total_ms) {
  JsonWriter json;
  json.begin_object()
      .member("points", std::uint64_t{field.pressures.size()})
      .member("peak_pa", field.peak_pa())
      .member("peak_m", field.places.points[field.loudest])
      .member("sound_speed_m_s", air.medium.sound_speed)
      .member("density_kg_m3", air.density_kg_m3)
      .member("absorption_np_m", air.absorption_np_m);
  json.key("timing_ms").begin_object().member("field", field.sum_ms).member("total", total_ms).end_object();
  json.end_object();
  return json.take();
}

std::string summary(const Field& field, const acoustics::Air& air) {
  const Vec3 at = field.places.points[field.loudest] * 1e3;
  std::string text = fmt::format("{} points in {:.2f} s: at most {:.0f} Pa, at ({:.2f}, {:.2f}, {:.2f}) mm\n",
                                 field.pressures.size(), field.sum_ms / 1e3, field.peak_pa(), at.x, at.y, at.z);
  fmt::format_to(std::back_inserter(text), "air: {:.2f} m/s, {:.4f} kg/m3, absorbs {:.4f} Np/m\n",
                 air.medium.sound_speed, air.density_kg_m3, air.absorption_np_m);
  return text + (field.peak_pa() > array::linear_pressure_pa ? setup::linear_line() : "");
}

void run(const FieldCommand& o) {
  const auto begin = Clock::now();
  check(o);
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}, {"--vtu", o.vtu}, {"--png", o.png}});
  const acoustics::Air air = setup::air(o.drive.medium, o.air);
  const array::Layout layout = array::load_layout(o.layout);
  setup::warn_of_frequency(layout, air.medium);
  Field field{.places = setup::load_places(o.place), .pressures = {}};
  const Sound sound = sound_of(o, layout);
  log::release_warnings();

  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  sum(o, layout, air, sound.drive, field);
  progress.reset();

  if (!o.csv.empty()) write_csv(o.csv, field);
  if (!o.vtu.empty()) write_vtu(o.vtu, field);
  if (!o.png.empty()) draw_png(o, title_of(o, layout, sound), air, field);
  if (!o.common.json.empty()) write_file(o.common.json, to_json(field, air, milliseconds_since(begin)));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary(field, air));
}

}  // namespace

void add_field(Program& program) {
  add_subcommand<FieldCommand>(
      program,
      {"field", "the sound field of an array on a plane, a line or at points",
       "  palpa field --layout openmpd --focus 0,0,150mm --plane xz --centre 0,0,120mm --size 120mm,160mm --png "
       "field.png\n"
       "  palpa field --layout paper --drive drive.csv --line 0,0,-20mm 0,0,20mm --samples 401 --csv -\n"
       "  palpa field --layout autd3 --focus 0,0,200mm --points assets/finger.ply --vtu finger.vtu --directivity "
       "piston\n"
       "In the layout's own frame. Pressures are peak, time factor e^-iwt; free field, no finger in the way."},
      add_options, run);
}

}  // namespace palpa::cli
