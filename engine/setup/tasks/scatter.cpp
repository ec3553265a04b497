#include "setup/tasks/scatter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/far_force.hpp"
#include "acoustics/field/incident.hpp"
#include "acoustics/field/waves.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/system/parallel.hpp"
#include "line/values.hpp"
#include "setup/files/body.hpp"
#include "setup/files/drive_file.hpp"
#include "setup/options/warnings.hpp"
#include "setup/tasks/foci.hpp"
#include "setup/tasks/force_check.hpp"

namespace palpa::setup {
namespace {

IncidentSound load_sound(const ScatterTask& task) {
  if (!task.plane_wave.empty()) {
    const auto [x, y, z] = line::parse_direction("--plane-wave", task.plane_wave);
    return PlaneWave{{x, y, z}};
  }
  if (!task.point_source.empty()) {
    const auto [x, y, z] = line::parse_point("--point-source", task.point_source);
    return PointSource{{x, y, z}};
  }
  array::Layout layout = array::load_layout(task.layout);
  array::Drive drive = load_drive(task.drive_file, layout);
  return ArraySound{std::move(layout), std::move(drive), task.directivity.value_or(array::Directivity::t4010a1)};
}

void check_sound(const std::string& name, const IncidentSound& sound, const acoustics::Air& air,
                 const geometry::Mesh& body, bool force) {
  if (const auto* const plane = std::get_if<PlaneWave>(&sound)) {
    const double length = glm::length(plane->direction);
    if (!(length > 0 && std::isfinite(length))) throw bad_usage("a plane wave needs a direction whose length is not 0");
  } else if (const auto* const point = std::get_if<PointSource>(&sound)) {
    const Vec3& p = point->position;
    if (!(std::abs(p.x) <= line::farthest_point_m && std::abs(p.y) <= line::farthest_point_m &&
          std::abs(p.z) <= line::farthest_point_m))
      throw bad_usage(fmt::format("the point source is not within {} m", line::farthest_point_m));
    acoustics::check_source(body, p, force);
  } else if (const auto* const array = std::get_if<ArraySound>(&sound)) {
    warn_of_frequency(array->layout, air.medium);
    acoustics::check_clear_of(name, body, array->layout);
    check_drive(array->layout, array->drive);
  }
  // An absorbing medium has no plane wave of 1 Pa everywhere.
  if (!std::holds_alternative<ArraySound>(sound) && air.absorption_np_m > 0)
    throw bad_usage("--absorption goes with --drive: the plane wave and the point source are computed in lossless air");
}

/// The incident wave, of any kind.
class Wave {
 public:
  /// `sound` must outlive it.
  Wave(const IncidentSound& sound, const acoustics::Air& air) : sound_(sound), air_(air) {
    if (const auto* const array = std::get_if<ArraySound>(&sound)) strengths_ = acoustics::strengths_of(array->drive);
  }

  acoustics::Waves at(std::span<const Vec3> points, std::span<const Vec3> normals) const {
    if (const auto* const plane = std::get_if<PlaneWave>(&sound_))
      return acoustics::plane_wave(air_.wave_number(), glm::normalize(plane->direction), points, normals);
    if (const auto* const point = std::get_if<PointSource>(&sound_))
      return acoustics::point_source(air_.wave_number(), point->position, points, normals);
    const ArraySound& array = std::get<ArraySound>(sound_);
    acoustics::Waves waves;
    acoustics::Incident(array.layout, air_, array.directivity).at(points, normals, strengths_, waves);
    return waves;
  }

  /// The force by the momentum in the air, if it is defined.
  std::optional<Vec3> far_force(const acoustics::RigidBody& body, std::span<const std::complex<float>> unknowns) const {
    std::vector<Vec3> sources;
    const auto* const array = std::get_if<ArraySound>(&sound_);
    if (const auto* const point = std::get_if<PointSource>(&sound_)) sources.push_back(point->position);
    if (array) {
      for (const array::Transducer& transducer : array->layout.transducers)
        sources.push_back(transducer.position);
    }
    const std::optional<acoustics::FarForce> far = acoustics::FarForce::of(body, sources);
    if (!far) return {};
    if (!array) return far->forces(at(far->points(), far->normals()), unknowns, air_)[0];
    const acoustics::Strengths lossless =
        acoustics::without_absorption(strengths_, array->layout, air_, acoustics::loudest_vertex(body, unknowns));
    acoustics::Waves waves;
    acoustics::Incident(array->layout, acoustics::without_absorption(air_), array->directivity)
        .at(far->points(), far->normals(), lossless, waves);
    return far->forces(waves, unknowns, air_)[0];
  }

 private:
  const IncidentSound& sound_;
  acoustics::Air air_;
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

/// Computes the result for a checked body and a checked sound.
ScatterResult solve(const std::string& name, geometry::Mesh mesh, const IncidentSound& sound, const acoustics::Air& air,
                    std::vector<Vec3> points) {
  ScatterResult result;
  result.points = std::move(points);
  result.air = air;
  result.from_array = std::holds_alternative<ArraySound>(sound);
  const Wave wave(sound, air);
  Stopwatch watch;
  const acoustics::RigidBody body(std::move(mesh), air.wave_number());
  result.times.emplace_back("operator", watch.lap_ms());
  const acoustics::Waves incident = wave.at(body.points(), body.normals());
  result.times.emplace_back("incident", watch.lap_ms());
  const std::vector<std::complex<float>> unknowns = body.solve(incident);
  result.faces = body.at_faces(unknowns);
  result.times.emplace_back("solution", watch.lap_ms());
  acoustics::SkinPressure pressure;
  acoustics::add_pressure(body, unknowns, air, 1, pressure);
  result.loudest_pa = pressure.loudest_pa;
  result.body = body.mesh();
  result.effort = body.effort();
  result.load = pressure.langevin_load;
  result.times.emplace_back("pressure", watch.lap_ms());
  result.far_force = wave.far_force(body, unknowns);
  result.times.emplace_back("far_force", watch.lap_ms());
  result.totals = around(body, wave, unknowns, result.points);
  if (!result.points.empty()) result.times.emplace_back("places", watch.lap_ms());
  if (result.far_force) warn_of_force(name, pressure, *result.far_force);
  return result;
}

}  // namespace

void check(const ScatterTask& task) {
  if (task.mesh.empty()) throw bad_usage("--mesh is missing: give the rigid body, a closed PLY or glTF mesh");
  const int waves = !task.plane_wave.empty() + !task.point_source.empty() + !task.drive_file.empty();
  if (waves != 1) {
    throw bad_usage(waves == 0
                        ? "nothing sounds: give --plane-wave x,y,z, --point-source x,y,z, or --layout and --drive"
                        : "--plane-wave, --point-source and --drive exclude each other: give one of them");
  }
  if (task.drive_file.empty() != task.layout.empty()) throw bad_usage("--layout and --drive go together: give both");
  if (task.directivity && task.drive_file.empty())
    throw bad_usage("--directivity goes with --drive: it belongs to an array's transducers");
}

bool ScatterResult::beyond_linear() const {
  return from_array && loudest_pa > array::linear_pressure_pa;
}

std::string to_json(const ScatterResult& result) {
  JsonWriter json;
  json.begin_object().member("faces", std::uint64_t{result.body.triangles.size()}).member("force_N", result.load.force);
  json.member("force_far_N", result.far_force);
  json.member("torque_Nm", result.load.torque).member("density_kg_m3", result.air.density_kg_m3);
  add_solution(json, result.effort);
  json.key("timing_ms").begin_object();
  for (const auto& [stage, ms] : result.times)
    json.member(stage, ms);
  json.end_object().end_object();
  return json.take();
}

ScatterResult scatter(const std::string& name, const geometry::Mesh& mesh, const IncidentSound& sound,
                      const acoustics::Air& air, std::vector<Vec3> points, bool force) {
  geometry::Mesh body = body_of(name, mesh, air, force);
  check_sound(name, sound, air, body, force);
  if (!points.empty()) points = point_places(std::move(points)).points;
  return solve(name, std::move(body), sound, air, std::move(points));
}

ScatterResult scatter(const ScatterTask& task, const std::function<void()>& all_read) {
  check(task);
  const acoustics::Air air = setup::air(task.medium, task.air);
  geometry::Mesh body = load_body(task.mesh, air, task.force);
  const IncidentSound sound = load_sound(task);
  check_sound(task.mesh, sound, air, body, task.force);
  Places places = task.place.given() ? load_places(task.place) : Places();
  if (all_read) all_read();
  return solve(task.mesh, std::move(body), sound, air, std::move(places.points));
}

}  // namespace palpa::setup
