#include "setup/tasks/simulate_result.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>

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

JsonRows<acoustics::Spot> spot_rows() {
  using Spot = acoustics::Spot;
  return JsonRows<Spot>()
      .value("peak_pa", [](const Spot& s) { return s.peak_pa; })
      .value("peak_m", [](const Spot& s) { return s.peak_at; })
      .value("half_area_m2", [](const Spot& s) { return s.half_area_m2; })
      .value("half_radius_m", [](const Spot& s) { return s.half_radius_m; })
      .value("elongation", [](const Spot& s) { return s.elongation; });
}

/// Like the foci, empty for an empty sector. Nothing if the foci sound where they are.
std::optional<std::vector<std::optional<Vec3>>> aimed_of(const SimulateResult& result) {
  if (result.aimed.empty()) return std::nullopt;
  std::vector<std::optional<Vec3>> aimed;
  std::size_t next = 0;
  for (const std::optional<Vec3>& focus : result.foci)
    aimed.push_back(focus ? std::optional(result.aimed[next++]) : std::nullopt);
  return aimed;
}

/// A finger in time, as in the JSON of a touch.
struct FingerInTime {
  const std::string& solid;
  FeltFinger felt;
};

std::optional<std::vector<FingerInTime>> fingers_in_time(const SimulateResult& result) {
  if (result.fingers.empty()) return std::nullopt;
  std::vector<FingerInTime> fingers;
  for (std::size_t f = 0; f < result.fingers.size(); ++f)
    fingers.push_back({result.touched[f], {result.fingers[f], result.spectra.empty() ? nullptr : &result.spectra[f]}});
  return fingers;
}

}  // namespace

const JsonRows<SimulateResult>& simulate_rows() {
  using Result = SimulateResult;
  static const auto body =
      JsonRows<Result>()
          .value("faces", [](const Result& r) { return std::uint64_t{r.body.triangles.size()}; })
          .value("vertices", [](const Result& r) { return std::uint64_t{r.body.positions.size()}; });
  static const auto finger = JsonRows<FingerInTime>()
                                 .value("solid", [](const FingerInTime& f) { return std::string_view(f.solid); })
                                 .members(felt_rows(), [](const FingerInTime& f) { return f.felt; });
  static const auto rows =
      JsonRows<Result>()
          .object("finger", body, [](const Result& r) { return &r; })
          .value("method", [](const Result& r) { return word_of(touch::method_words, r.method); })
          .value("penetration_m", [](const Result& r) { return r.penetration_m; })
          .members(array::driven_rows(), [](const Result& r) { return r.by; })
          .value("foci_m", [](const Result& r) { return &r.foci; })
          .value("aimed_m", aimed_of)
          .object("langevin", spot_rows(), [](const Result& r) { return &r.langevin; })
          .object("squared", spot_rows(), [](const Result& r) { return &r.squared; })
          .value("force_N", [](const Result& r) { return r.load.force; })
          .written({"force_far_N.#"},
                   [](JsonWriter& json, const Result& r) { json.member("force_far_N", r.far_force); })
          .value("torque_Nm", [](const Result& r) { return r.load.torque; })
          .objects("fingers", finger, fingers_in_time, JsonWriter::Style::block)
          .object(
              "solution", solution_rows(), [](const Result& r) { return r.effort.iterates ? &r.effort : nullptr; },
              JsonWriter::Style::line)
          .object("spread", simulate_spread_rows(), [](const Result& r) { return r.spread ? &*r.spread : nullptr; })
          .written({}, [](JsonWriter& json, const Result& r) {
            json.key("timing_ms").begin_object();
            for (const auto& [stage, ms] : r.times)
              json.member(stage, ms);
            json.end_object();
            if (r.bare_elongation) json.member("bare_elongation", *r.bare_elongation);
          });
  return rows;
}

std::string to_json(const SimulateResult& result) {
  return simulate_rows().text(result);
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
