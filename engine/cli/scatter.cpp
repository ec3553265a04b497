#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/incident.hpp"
#include "acoustics/field/waves.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "base/parallel.hpp"
#include "cli/commands.hpp"
#include "setup/body.hpp"
#include "setup/drive_file.hpp"
#include "setup/options.hpp"
#include "setup/places.hpp"
#include "setup/progress.hpp"
#include "setup/touch_run.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

struct ScatterCommand {
  setup::CommonOptions common;
  std::string mesh;
  bool force = false;
  std::string plane_wave, point_source, layout, drive_file;
  std::optional<array::Directivity> directivity;  ///< normally t4010a1
  setup::PlaceOptions place;
  std::string csv;
  setup::MediumOptions medium;
  setup::AirOptions air{.absorption = false};
};

void add_options(CLI::App& app, ScatterCommand& o) {
  const setup::Group body(app, "What scatters");
  body.text("--mesh", o.mesh, "FILE", "the rigid body, a closed PLY or glTF mesh");
  body.flag("--force", o.force, "scatter by a mesh that is too coarse for the wavelength, or for the source, too");
  add_allow_outside(body, o.common);
  const setup::Group sound(app, "What sounds");
  sound.text("--plane-wave", o.plane_wave, "X,Y,Z", "the plane wave that travels along it: 1 Pa, phase 0 at the origin",
             [](const std::string& text) { setup::parse_direction("--plane-wave", text); });
  sound.point("--point-source", o.point_source, "e^{ikr}/r Pa, r metres from there");
  sound.text("--layout", o.layout, "NAME|FILE", "the array of --drive; the mesh is in its frame");
  sound.text("--drive", o.drive_file, "FILE", "the drive of that layout, as palpa drive --csv writes it");
  sound.choice("--directivity", o.directivity, array::directivity_words, "of the array's transducers [t4010a1]");
  setup::add_place_options(app, o.place);
  const setup::Group results(app, "Results");
  results.text("--csv", o.csv, "FILE|-",
               "face,x,y,z,re,im: total pressure at each face's centroid; of places x,y,z,re,im, nan inside");
  setup::add_medium_options(app, o.medium);
  setup::add_air_options(app, o.air);
}

void check(const ScatterCommand& o) {
  if (o.mesh.empty()) throw bad_usage("--mesh is missing: give the rigid body, a closed PLY or glTF mesh");
  const int waves = !o.plane_wave.empty() + !o.point_source.empty() + !o.drive_file.empty();
  if (waves != 1) {
    throw bad_usage(waves == 0
                        ? "nothing sounds: give --plane-wave x,y,z, --point-source x,y,z, or --layout and --drive"
                        : "--plane-wave, --point-source and --drive exclude each other: give one of them");
  }
  if (o.drive_file.empty() != o.layout.empty()) throw bad_usage("--layout and --drive go together: give both");
  if (o.directivity && o.drive_file.empty())
    throw bad_usage("--directivity goes with --drive: it is of an array's transducers");
  setup::refuse_without_place(o.place);
  setup::refuse_gpu_options(o.common, "palpa scatter computes on the processor");
}

/// The incident wave, whichever it is.
class Wave {
 public:
  Wave(const ScatterCommand& o, const acoustics::Air& air, const geometry::Mesh& body)
      : air_(air), directivity_(o.directivity.value_or(array::Directivity::t4010a1)) {
    if (!o.plane_wave.empty()) {
      const auto [x, y, z] = setup::parse_direction("--plane-wave", o.plane_wave);
      direction_ = glm::normalize(Vec3(x, y, z));
    } else if (!o.point_source.empty()) {
      const auto [x, y, z] = setup::parse_point("--point-source", o.point_source);
      source_ = Vec3(x, y, z);
      acoustics::check_source(body, *source_, o.force);
    } else {
      layout_ = array::load_layout(o.layout);
      setup::warn_of_frequency(layout_, air.medium);
      acoustics::check_clear_of(o.mesh, body, layout_);
      strengths_ = acoustics::strengths_of(setup::load_drive(o.drive_file, layout_));
    }
    // An absorbing medium has no plane wave of 1 Pa everywhere.
    if (strengths_.empty() && air.absorption_np_m > 0)
      throw bad_usage("--absorption goes with --drive: plane wave and point source are those of a lossless air");
  }

  acoustics::Waves at(std::span<const Vec3> points, std::span<const Vec3> normals) const {
    if (direction_) return acoustics::plane_wave(air_.wave_number(), *direction_, points, normals);
    if (source_) return acoustics::point_source(air_.wave_number(), *source_, points, normals);
    acoustics::Waves waves;
    acoustics::Incident(layout_, air_, directivity_).at(points, normals, strengths_, waves);
    return waves;
  }

 private:
  acoustics::Air air_;
  array::Directivity directivity_;
  std::optional<Vec3> direction_, source_;
  array::Layout layout_;
  acoustics::Strengths strengths_;
};

using Pressures = std::vector<std::complex<double>>;

/// Total pressure in the air and on the skin; not a number inside of the body.
Pressures around(const acoustics::RigidBody& body, const Wave& wave, std::span<const std::complex<float>> unknowns,
                 std::span<const Vec3> points) {
  using Where = acoustics::BodyPlace::Where;
  if (points.empty()) return {};
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Pressures total(points.size(), {nan, nan});
  const acoustics::BodyPlaces places(body.patches());
  std::vector<Where> where(points.size());
  parallel_chunks(points.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const acoustics::BodyPlace place = places.of(points[i]);
      where[i] = place.where;
      if (place.where == Where::skin) total[i] = body.at_skin(unknowns, place.face, place.u, place.v).pressure;
    }
  });
  std::vector<Vec3> in_air;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (where[i] != Where::air) continue;
    in_air.push_back(points[i]);
    rows.push_back(i);
  }
  const Pressures scattered = body.scattered(unknowns, in_air), incident = wave.at(in_air, {}).pressures;
  for (std::size_t i = 0; i < in_air.size(); ++i)
    total[rows[i]] = incident[i] + scattered[i];
  return total;
}

std::string row(const Vec3& at, const std::complex<double>& p) {
  return fmt::format("{},{},{},{},{}\n", at.x, at.y, at.z, static_cast<float>(p.real()), static_cast<float>(p.imag()));
}

void write_faces(const std::string& file, const geometry::Mesh& mesh, const std::vector<acoustics::FaceSound>& sound) {
  OutputFile csv(file);
  csv.write("face,x,y,z,re,im\n");
  for (std::size_t face = 0; face < sound.size(); ++face)
    csv.write(fmt::format("{},", face) + row(acoustics::face_centroid(mesh, face), sound[face].pressure));
  csv.finish();
}

void write_points(const std::string& file, std::span<const Vec3> points, const Pressures& pressures) {
  OutputFile csv(file);
  csv.write("x,y,z,re,im\n");
  for (std::size_t i = 0; i < points.size(); ++i)
    csv.write(row(points[i], pressures[i]));
  csv.finish();
}

std::string to_json(const geometry::Mesh& mesh, const acoustics::Load& load, const acoustics::Air& air,
                    const setup::StageTimes& times) {
  JsonWriter json;
  json.begin_object()
      .member("faces", std::uint64_t{mesh.triangles.size()})
      .member("force_N", load.force)
      .member("torque_Nm", load.torque)
      .member("density_kg_m3", air.density_kg_m3);
  json.key("timing_ms").begin_object();
  for (const auto& [stage, ms] : times)
    json.member(stage, ms);
  json.end_object().end_object();
  return json.take();
}

std::string summary(const geometry::Mesh& mesh, const std::vector<acoustics::FaceSound>& sound,
                    const acoustics::Load& load, const setup::StageTimes& times) {
  std::size_t loudest = 0;
  double ms = 0;
  for (std::size_t face = 0; face < sound.size(); ++face) {
    if (std::norm(sound[face].pressure) > std::norm(sound[loudest].pressure)) loudest = face;
  }
  for (const auto& stage : times)
    ms += stage.second;
  const Vec3 at = acoustics::face_centroid(mesh, loudest) * 1e3;
  return fmt::format(
      "{} faces in {:.2f} s: at most {:.4g} Pa, at ({:.2f}, {:.2f}, {:.2f}) mm\n"
      "radiation force ({:.3g}, {:.3g}, {:.3g}) N\n",
      mesh.triangles.size(), ms / 1e3, std::abs(sound[loudest].pressure), at.x, at.y, at.z, load.force.x, load.force.y,
      load.force.z);
}

void run(const ScatterCommand& o) {
  check(o);
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}});
  const acoustics::Air air = setup::air(o.medium, o.air);
  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  geometry::Mesh mesh = setup::load_body(o.mesh, air, o.force);
  const Wave wave(o, air, mesh);
  const setup::Places places = o.place.given() ? setup::load_places(o.place) : setup::Places();
  log::release_warnings();

  setup::StageTimes times;
  setup::Stopwatch watch;
  const acoustics::RigidBody body(std::move(mesh), air.wave_number());
  times.emplace_back("operator", watch.lap_ms());
  const acoustics::Waves incident = wave.at(body.points(), body.normals());
  times.emplace_back("incident", watch.lap_ms());
  const std::vector<std::complex<float>> unknowns = body.solve(incident);
  const std::vector<acoustics::FaceSound> sound = body.at_faces(unknowns);
  times.emplace_back("solution", watch.lap_ms());
  const Pressures pressures = around(body, wave, unknowns, places.points);
  if (o.place.given()) times.emplace_back("places", watch.lap_ms());
  progress.reset();

  acoustics::SkinPressure pressure;
  acoustics::add_pressure(sound, air, 1, pressure);
  const acoustics::Load load = acoustics::load_on(body.mesh(), pressure.langevin, {});
  if (!o.csv.empty()) {
    if (o.place.given()) {
      write_points(o.csv, places.points, pressures);
    } else {
      write_faces(o.csv, body.mesh(), sound);
    }
  }
  if (!o.common.json.empty()) write_file(o.common.json, to_json(body.mesh(), load, air, times));
  if (!setup::shows_summary(o.common, outputs)) return;
  const bool loud = !o.drive_file.empty() && pressure.loudest_pa > array::linear_pressure_pa;
  write_file("-", summary(body.mesh(), sound, load, times) + (loud ? setup::linear_line() : ""));
}

}  // namespace

void add_scatter(Program& program) {
  add_subcommand<ScatterCommand>(
      program,
      {"scatter", "sound scattered by a rigid body, by boundary elements",
       "  palpa scatter --mesh sphere.ply --plane-wave 0,0,1 --csv surface.csv\n"
       "  palpa scatter --mesh assets/finger.ply --layout paper --drive drive.csv --json -\n"
       "  palpa scatter --mesh sphere.ply --point-source 0,0,100mm --plane xz --centre 0,0,0 --size 60mm,60mm --csv "
       "f.csv\n"
       "Total pressures, peak, time factor e^-iwt; force and torque, about the origin, of the radiation pressure."},
      add_options, run);
}

}  // namespace palpa::cli
