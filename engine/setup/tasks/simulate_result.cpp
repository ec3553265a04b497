#include "setup/tasks/simulate_result.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <iterator>

#include "array/schedule.hpp"
#include "base/words.hpp"
#include "geometry/files/vtu.hpp"
#include "setup/files/body.hpp"
#include "setup/tasks/felt_json.hpp"

namespace palpa::setup {

bool SimulateResult::beyond_linear() const {
  return pressure.loudest_pa > array::linear_pressure_pa;
}

namespace {

void add_spot(JsonWriter& json, const char* name, const acoustics::Spot& spot) {
  json.key(name)
      .begin_object()
      .member("peak_pa", spot.peak_pa)
      .member("peak_m", spot.peak_at)
      .member("half_area_m2", spot.half_area_m2)
      .member("half_radius_m", spot.half_radius_m)
      .member("elongation", spot.elongation)
      .end_object();
}

/// Like the foci, with null for an empty sector.
void add_aimed(JsonWriter& json, const SimulateResult& result) {
  json.key("aimed_m").begin_array();
  std::size_t next = 0;
  for (const std::optional<Vec3>& focus : result.foci) {
    if (focus) {
      json.value(result.aimed[next++]);
    } else {
      json.null();
    }
  }
  json.end_array();
}

/// As for a touch: one object for each finger.
void add_in_time(JsonWriter& json, const SimulateResult& result) {
  json.key("fingers").begin_array(JsonWriter::Style::block);
  for (std::size_t f = 0; f < result.fingers.size(); ++f) {
    json.begin_object().member("solid", result.touched[f]);
    add_felt(json, result.fingers[f], result.spectra.empty() ? nullptr : &result.spectra[f]);
    json.end_object();
  }
  json.end_array();
}

}  // namespace

void add_members(JsonWriter& json, const SimulateResult& result) {
  json.key("finger")
      .begin_object()
      .member("faces", std::uint64_t{result.body.triangles.size()})
      .member("vertices", std::uint64_t{result.body.positions.size()})
      .end_object();
  json.member("method", word_of(touch::method_words, result.method)).member("penetration_m", result.penetration_m);
  json.member("foci_m", result.foci);
  if (!result.aimed.empty()) add_aimed(json, result);
  add_spot(json, "langevin", result.langevin);
  add_spot(json, "squared", result.squared);
  json.member("force_N", result.load.force);
  json.member("force_far_N", result.far_force);
  json.member("torque_Nm", result.load.torque);
  if (!result.fingers.empty()) add_in_time(json, result);
  add_solution(json, result.effort);
  if (result.spread) add_spread(json, *result.spread);
  json.key("timing_ms").begin_object();
  for (const auto& [stage, ms] : result.times)
    json.member(stage, ms);
  json.end_object();
  if (result.bare_elongation) json.member("bare_elongation", *result.bare_elongation);
}

std::string to_json(const SimulateResult& result) {
  JsonWriter json;
  json.begin_object();
  add_members(json, result);
  json.end_object();
  return json.take();
}

std::string to_csv(const SimulateResult& result) {
  std::string csv = "face,x,y,z,area,langevin,squared\n";
  for (std::size_t face = 0; face < result.body.triangles.size(); ++face) {
    const Vec3 at = acoustics::face_centroid(result.body, face);
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{}\n", face, at.x, at.y, at.z,
                   acoustics::face_area(result.body, face), result.pressure.langevin[face],
                   result.pressure.squared[face]);
  }
  return csv;
}

void write_vtu(const std::string& file, const SimulateResult& result) {
  geometry::VtuCells cells{.shape = geometry::VtuCells::Shape::triangle, .corners = {}};
  for (const glm::uvec3& t : result.body.triangles)
    cells.corners.insert(cells.corners.end(), {t.x, t.y, t.z});
  const std::vector<float> langevin(result.pressure.langevin.begin(), result.pressure.langevin.end());
  const std::vector<float> squared(result.pressure.squared.begin(), result.pressure.squared.end());
  const geometry::VtuValues values[]{{"langevin (Pa)", langevin}, {"squared (Pa)", squared}};
  geometry::write_vtu(file, result.body.positions, cells, {}, values);
}

}  // namespace palpa::setup
