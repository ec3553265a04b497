#include "sweep/estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/files/ply.hpp"
#include "sensing/rig.hpp"
#include "setup/assets.hpp"
#include "setup/load.hpp"

namespace palpa::sweep {
namespace {

// Measured with `palpa sweep` and `palpa bench` on two cores of a Xeon (AVX-512) without a GPU.
constexpr double touch_s = 2e-3, touch_cpu_s = 0.7e-3;  // a touch of points, with the device and its pipelines at hand
constexpr double point_s = 0.02e-6;                     // each skin point
constexpr double image_s = 15e-3;                       // each depth image
constexpr double load_s_per_face = 5e-6;                // reading and checking a model
// sorting its faces into a grid
constexpr double convex_s_per_face = 7e-6, concave_s_per_face = 40e-6;
constexpr double kept_faces = 5000;                  // from this number on, a concave solid's grid is kept in the cache
constexpr double upload_s_per_face = 3.5e-6;         // of a kept grid, to the device
constexpr double felt_s = 2e-4, tune_s = 7e-4;       // of a touch: a spectrum, a choice of foci
constexpr double drive_s = 1e-4, source_s = 0.8e-6;  // a drive, and each transducer in its results
constexpr double pair_s = 1.6e-9, pair_cpu_s = 4.7e-9;  // transducer and point: their sound
constexpr double host_pair_s = 1e-8;                    // transducer and focus of a random array
constexpr double turn_pair_s = 1e-9;                    // transducer and focus, in each iteration of a solver
constexpr double solver_turns = 100;                    // iterations of the solvers that have some
constexpr double operator_s_per_face2 = 3.1e-8, operator_s_per_face3 = 9e-13;  // dense: matrix, factors
constexpr double operator_bytes_per_face2 = 2.1;
constexpr double fast_operator_s_per_face = 4e-4, fast_operator_bytes_per_face = 16e3;
constexpr double fast_solve_s_per_face = 1e-5;  // and sound
constexpr double most_dense_faces = 6000;
constexpr double simulate_s = 0.1;  // a simulation, beside its operator and its sounds
constexpr double simulate_felt_s = 0.5, simulate_tune_s = 2;
constexpr double skin_pair_s = 1.1e-9;  // transducer and face: the incident sound
constexpr double face_bytes = 20e3;     // the sounds of ten foci
/// A larger model is not read for an estimate. Its faces are counted by its bytes, twelve for each.
constexpr double most_bytes_read = 4e6, bytes_per_face = 12;
constexpr double model_bytes_per_face = 250;

/// The same on both backends.
Cost same(double seconds, double bytes = 0) {
  return {seconds, seconds, 0, bytes};
}

/// The operator of a body with that many faces (acoustics/compressed/body_operator.hpp).
Cost operator_cost(double faces) {
  if (faces > most_dense_faces) return same(faces * fast_operator_s_per_face, faces * fast_operator_bytes_per_face);
  const double square = faces * faces;
  return same(square * operator_s_per_face2 + square * faces * operator_s_per_face3, square * operator_bytes_per_face2);
}

Cost plus(Cost a, const Cost& b) {
  return {a.seconds + b.seconds, a.cpu_seconds + b.cpu_seconds, a.first_s + b.first_s, a.bytes + b.bytes};
}

/// A drive of that many transducers and foci.
Cost drive_cost(const setup::DriveOptionsGroup& drive, double sources, double foci) {
  const bool naive = !drive.solver || *drive.solver == setup::SolverChoice::naive;
  return same(sources * foci * (naive && !drive.pressure_pa ? 1 : solver_turns) * turn_pair_s);
}

double draws_of(const setup::SpreadOptions& spread) {
  return spread.text.empty() ? 0 : spread.draws.value_or(setup::usual_draws);
}

/// "a,b" as two quantities.
std::optional<std::pair<double, double>> both(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto first = parse_quantity(text.substr(0, comma), Quantity::length);
  const auto second = parse_quantity(text.substr(comma + 1), Quantity::length);
  if (!first || !second) return std::nullopt;
  return std::pair(*first, *second);
}

double samples_of_plane(const setup::PlaceOptions& place) {
  if (const auto pixels = both(place.pixels)) return pixels->first * pixels->second;
  const auto size = both(place.size);
  if (!size || !(size->first > 0 && size->second > 0)) return 0;
  const auto [least, most] = std::minmax(size->first, size->second);
  return 256.0 * std::max(1.0, 256.0 * least / most);
}

/// Options that change what a case computes, but hardly how long it takes.
bool is_free(const std::string& option) {
  constexpr std::string_view free[] = {"--delta",      "--dwell",       "--seed",     "--stride",       "--temperature",
                                       "--frequency",  "--sound-speed", "--humidity", "--air-pressure", "--penetration",
                                       "--finger-gap", "--min-points",  "--spacing",  "--amplitude"};
  return std::ranges::find(free, option) != std::end(free);
}

/// Options that say which grid of a model's faces a case needs.
bool is_of_model(const std::string& option) {
  constexpr std::string_view of_model[] = {"--scene", "--gltf-scene",     "--surface",
                                           "--parts", "--internal-faces", "--delta"};
  return std::ranges::find(of_model, option) != std::end(of_model);
}

}  // namespace

Estimator::Estimator(const Plan& plan, const Inputs& inputs) : plan_(plan), inputs_(inputs) {}

Cost Estimator::cost(const std::vector<Setting>& settings) {
  std::vector<Setting> that_count;
  std::ranges::copy_if(settings, std::back_inserter(that_count), [](const Setting& s) { return !is_free(s.option); });
  const std::string key = inputs_.canonical(that_count);
  const auto [known, is_new] = known_.emplace(key, Cost());
  if (is_new) known->second = estimate(settings);
  Cost cost = known->second;
  if (cost.first_s == 0) return cost;
  std::vector<Setting> of_model;
  std::ranges::copy_if(settings, std::back_inserter(of_model), [](const Setting& s) { return is_of_model(s.option); });
  if (!prepared_.insert(inputs_.canonical(of_model)).second) cost.first_s = 0;
  return cost;
}

Cost Estimator::estimate(const std::vector<Setting>& settings) {
  try {
    const std::unique_ptr<Line> line = read_line(command_of(plan_.command), given_by(inputs_.resolved(settings)));
    check_line(*line);
    return std::visit([&](const auto& of_command) { return of(of_command); }, *line);
  } catch (const Error&) {
    return {};
  }
}

Cost Estimator::of(const setup::TouchLine& line) {
  double seconds = 0;
  if (!line.input.points.empty()) seconds += point_s * points(line.input.points);
  seconds += image_s * static_cast<double>(line.input.depths.size());
  const double foci = line.task.touch.parameters.foci;
  if (line.task.felt.spectrum) seconds += felt_s;
  if (line.task.touch.tune) seconds += tune_s;
  const double sources = transducers(line.task.array.layout);
  if (sources > 0) seconds += drive_s;
  Cost cost = plus({seconds + touch_s, seconds + touch_cpu_s, 0, 0}, drive_cost(line.task.array.drive, sources, foci));
  return plus(cost, prepare(line.input.scene, line.input.gltf_scene, line.input.solids));
}

Cost Estimator::of(const setup::DriveLine& line) {
  const double sources = transducers(line.task.layout);
  const auto foci = static_cast<double>(std::max<std::size_t>(1, line.task.foci.size()));
  const Cost cost = plus(same(drive_s + source_s * sources + host_pair_s * sources * foci * draws_of(line.task.spread)),
                         drive_cost(line.task.drive, sources, foci));
  if (line.task.mesh.empty()) return cost;
  const double skin = faces(line.task.mesh);
  return plus(plus(cost, operator_cost(skin)), same(skin_pair_s * sources * skin * foci, skin * face_bytes));
}

Cost Estimator::of(const setup::FieldLine& line) {
  const setup::PlaceOptions& place = line.task.place;
  const double samples = place.plane             ? samples_of_plane(place)
                         : !place.points.empty() ? points(place.points)
                                                 : place.samples.value_or(1000);
  const double sources = transducers(line.task.layout), draws = draws_of(line.task.spread);
  const double pairs = samples * sources * (1 + draws);
  return plus({drive_s + pair_s * pairs, drive_s + pair_cpu_s * pairs, 0, samples * (160 + 4 * draws)},
              drive_cost(line.task.drive, sources, static_cast<double>(line.task.foci.size())));
}

Cost Estimator::of(const setup::SimulateLine& line) {
  const double skin = faces(line.finger), foci = line.task.touch.parameters.foci;
  const bool named = !line.task.rig.layout.empty();
  const sensing::Rig rig =
      named ? sensing::Rig()
            : sensing::load_rig(line.task.rig.rig.empty() ? setup::find_asset("rigs/paper.toml") : line.task.rig.rig);
  const double sources = transducers(named ? line.task.rig.layout : rig.array ? rig.array->layout : "");
  const bool one = line.task.touch.method.method == touch::Method::single_focus ||
                   line.task.touch.method.method == touch::Method::multi_focus;
  const double sounds = one ? 1 : foci;
  double seconds = simulate_s + skin_pair_s * sources * skin * sounds;
  if (skin > most_dense_faces) seconds += fast_solve_s_per_face * skin * sounds;
  if (!setup::asks_for_finger(line.task.drive).empty()) seconds += skin_pair_s * sources * skin;
  if (line.task.in_time.spectrum) seconds += simulate_felt_s;
  if (line.task.touch.tune) seconds += simulate_tune_s;
  seconds += skin_pair_s * sources * skin * sounds * draws_of(line.task.spread);
  const Cost cost = plus(operator_cost(skin), same(seconds, skin * face_bytes));
  return plus(plus(cost, drive_cost(line.task.drive, sources, foci)),
              prepare(line.scene, line.gltf_scene, line.solids));
}

const Estimator::Faces& Estimator::model(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene,
                                         const setup::SolidOptions& options) {
  const std::string key = fmt::format("{}\n{}\n{}\n{}", scene, gltf_scene ? fmt::format("{}", *gltf_scene) : "",
                                      static_cast<int>(options.surface), options.parts.value_or(0));
  const auto [known, is_new] = models_.emplace(key, Faces());
  if (!is_new) return known->second;
  std::error_code fault;
  const auto bytes = static_cast<double>(std::filesystem::file_size(scene, fault));
  if (fault) return known->second;
  if (bytes > most_bytes_read) {
    known->second.kept = bytes / bytes_per_face;
    return known->second;
  }
  for (const geometry::Solid& solid : setup::load_solids(scene, gltf_scene, options)) {
    const auto count = static_cast<double>(solid.mesh.triangles.size());
    const bool is_convex = !solid.planes.empty() || !solid.parts.parts.empty();
    (is_convex ? known->second.convex : count < kept_faces ? known->second.concave : known->second.kept) += count;
  }
  return known->second;
}

Cost Estimator::prepare(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene,
                        const setup::SolidOptions& options) {
  const Faces& faces = model(scene, gltf_scene, options);
  const double sorted_s = faces.convex * convex_s_per_face + faces.concave * concave_s_per_face;
  return {sorted_s + faces.kept * upload_s_per_face, sorted_s,
          faces.all() * load_s_per_face + faces.kept * concave_s_per_face, faces.all() * model_bytes_per_face};
}

double Estimator::transducers(const std::string& layout) {
  if (layout.empty()) return 0;
  const auto [known, is_new] = transducers_.emplace(layout, 0);
  if (is_new) known->second = static_cast<double>(array::load_layout(layout).transducers.size());
  return known->second;
}

double Estimator::points(const std::string& file) {
  const auto [known, is_new] = points_.emplace(file, 0);
  if (is_new) known->second = static_cast<double>(geometry::read_ply(file).positions.size());
  return known->second;
}

double Estimator::faces(const std::string& file) {
  const auto [known, is_new] = faces_.emplace(file, 0);
  if (is_new) known->second = static_cast<double>(geometry::load_triangles(file).triangles.size());
  return known->second;
}

}  // namespace palpa::sweep
