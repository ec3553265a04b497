#include "setup/tasks/scatter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "acoustics/bodies/rigid_body.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "cli/commands.hpp"
#include "line/values.hpp"
#include "setup/options/options.hpp"
#include "setup/options/places.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/progress.hpp"

namespace palpa::cli {
namespace {

struct ScatterCommand {
  setup::CommonOptions common;
  setup::ScatterTask task;
  std::string csv;
};

void add_options_of_scatter(CLI::App& app, ScatterCommand& o) {
  const line::Group body(app, "What scatters");
  body.text("--mesh", o.task.mesh, "FILE", "the rigid body, a closed PLY or glTF mesh, in metres");
  body.flag("--force", o.task.force, "also takes a mesh whose faces are too coarse for the wavelength or the source");
  add_allow_outside(body, o.common);
  const line::Group sound(app, "What sounds");
  sound.text("--plane-wave", o.task.plane_wave, "X,Y,Z",
             "sounds a plane wave that travels in this direction: 1 Pa, phase 0 at the origin",
             [](const std::string& text) { line::parse_direction("--plane-wave", text); });
  sound.point("--point-source", o.task.point_source,
              "sounds a point source there: e^{ikr}/r Pa at a distance of r metres");
  sound.text("--layout", o.task.layout, "NAME|FILE", "the array that sounds --drive; the mesh is in its frame");
  sound.text("--drive", o.task.drive_file, "FILE", "the array's drive, as palpa drive --csv writes it");
  sound.choice("--directivity", o.task.directivity, array::directivity_words,
               "how a transducer's sound depends on direction [t4010a1]");
  setup::add_place_options(app, o.task.place);
  const line::Group results(app, "Results");
  results.text("--csv", o.csv, "FILE|-",
               "writes the total pressure at each face's centroid: face,x,y,z,re,im; or with --plane, --line or "
               "--points, at these places: x,y,z,re,im, nan inside the body");
  setup::add_medium_options(app, o.task.medium);
  setup::add_air_options(app, o.task.air);
}

std::string row(const Vec3& at, const std::complex<double>& p) {
  return fmt::format("{},{},{},{},{}\n", at.x, at.y, at.z, static_cast<float>(p.real()), static_cast<float>(p.imag()));
}

void write_faces(const std::string& file, const setup::ScatterResult& result) {
  OutputFile csv(file);
  csv.write("face,x,y,z,re,im\n");
  for (std::size_t face = 0; face < result.faces.size(); ++face) {
    csv.write(fmt::format("{},", face) + row(acoustics::face_centroid(result.body, face), result.faces[face].pressure));
  }
  csv.finish();
}

void write_points(const std::string& file, const setup::ScatterResult& result) {
  OutputFile csv(file);
  csv.write("x,y,z,re,im\n");
  for (std::size_t i = 0; i < result.points.size(); ++i)
    csv.write(row(result.points[i], result.totals[i]));
  csv.finish();
}

std::string summary_of_scatter(const setup::ScatterResult& result) {
  const auto loudest =
      std::ranges::max_element(result.faces, {}, [](const auto& face) { return std::norm(face.pressure); });
  double ms = 0;
  for (const auto& stage : result.times)
    ms += stage.second;
  const Vec3 at = acoustics::face_centroid(result.body, static_cast<std::size_t>(loudest - result.faces.begin())) * 1e3;
  const Vec3& force = result.load.force;
  return fmt::format(
             "{} faces in {:.2f} s: at most {:.4g} Pa, at ({:.2f}, {:.2f}, {:.2f}) mm\n"
             "radiation force ({:.3g}, {:.3g}, {:.3g}) N\n",
             result.faces.size(), ms / 1e3, std::abs(loudest->pressure), at.x, at.y, at.z, force.x, force.y, force.z) +
         (result.beyond_linear() ? setup::linear_line() : "");
}

void run_scatter(const ScatterCommand& o) {
  check(o.task);
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}});
  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  const setup::ScatterResult result = scatter(o.task, log::release_warnings);
  progress.reset();
  if (!o.csv.empty()) {
    if (o.task.place.given()) {
      write_points(o.csv, result);
    } else {
      write_faces(o.csv, result);
    }
  }
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_scatter(result));
}

}  // namespace

void add_scatter(Program& program) {
  add_subcommand<ScatterCommand>(
      program,
      {"scatter", "sound scattered by a rigid body, by boundary elements",
       "  palpa scatter --mesh assets/finger.ply --plane-wave 0,0,1 --csv surface.csv\n"
       "  palpa scatter --mesh assets/finger.ply --layout paper --drive drive.csv --json -",
       "--mesh --plane-wave --point-source --layout --drive --plane --size --line --points --csv",
       "Pressures are total pressures, peak values (time factor e^-iwt). Force and torque are those of the radiation "
       "pressure, the torque about the origin."},
      add_options_of_scatter, run_scatter, setup::Computes::on_processor);
}

}  // namespace palpa::cli
