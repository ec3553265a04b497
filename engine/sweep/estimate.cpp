#include "sweep/estimate.hpp"

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

namespace palpa::sweep {
namespace {

// Measured with `palpa sweep` and `palpa bench` on two cores of a Xeon (AVX-512) without a GPU.
constexpr double touch_s = 1e-3;         // a touch of points, with the device and its pipelines at hand
constexpr double point_s = 0.02e-6;      // each skin point
constexpr double image_s = 15e-3;        // each depth image
constexpr double model_s_per_mb = 0.05;  // reading and checking a model
constexpr double felt_s = 0.05;          // a spectrum, or a choice of foci
constexpr double drive_s = 3e-4;         // a drive, beside its pairs
constexpr double pair_s = 1.8e-9;        // transducer and point: their sound on the device
constexpr double host_pair_s = 1e-8;     // transducer and focus: on the host
constexpr double solver_turns = 100;     // iterations of the solvers that have some
constexpr double operator_s_per_face2 = 3.1e-8, operator_s_per_face3 = 9e-13;  // dense: matrix, factors
constexpr double operator_bytes_per_face2 = 2.1;
constexpr double fast_operator_s_per_face = 4e-4, fast_operator_bytes_per_face = 16e3;
constexpr double fast_solve_s_per_face = 1e-5;  // and sound
constexpr double most_dense_faces = 6000;
constexpr double simulate_s = 0.1;      // a simulation, beside its operator and its sounds
constexpr double skin_pair_s = 1.1e-9;  // transducer and face: the incident sound
constexpr double face_bytes = 20e3;     // the sounds of ten foci

/// The operator of a body with that many faces (acoustics/compressed/body_operator.hpp).
Cost operator_cost(double faces) {
  if (faces > most_dense_faces) return {faces * fast_operator_s_per_face, faces * fast_operator_bytes_per_face};
  const double square = faces * faces;
  return {square * operator_s_per_face2 + square * faces * operator_s_per_face3, square * operator_bytes_per_face2};
}

Cost plus(Cost a, const Cost& b) {
  return {a.seconds + b.seconds, a.bytes + b.bytes};
}

double turns_of(const setup::DriveOptionsGroup& drive) {
  const bool naive = !drive.solver || *drive.solver == setup::SolverChoice::naive;
  return naive && !drive.pressure_pa ? 1 : solver_turns;
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

}  // namespace

Estimator::Estimator(const Plan& plan, const Inputs& inputs) : plan_(plan), inputs_(inputs) {}

Cost Estimator::cost(const std::vector<Setting>& settings) {
  std::vector<Setting> that_count;
  std::ranges::copy_if(settings, std::back_inserter(that_count), [](const Setting& s) { return !is_free(s.option); });
  const std::string key = inputs_.canonical(that_count);
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  return known_[key] = estimate(settings);
}

Cost Estimator::estimate(const std::vector<Setting>& settings) {
  try {
    const std::unique_ptr<Line> line = read_line(command_of(plan_.command), given_by(inputs_.resolved(settings)));
    return std::visit([&](const auto& of_command) { return of(of_command); }, *line);
  } catch (const Error&) {
    return {};
  }
}

Cost Estimator::of(const setup::TouchLine& line) {
  Cost cost{touch_s + model_s_per_mb * megabytes(line.input.scene), megabytes(line.input.scene) * 20e6};
  if (!line.input.points.empty()) cost.seconds += point_s * points(line.input.points);
  cost.seconds += image_s * static_cast<double>(line.input.depths.size());
  const double foci = line.task.touch.parameters.foci;
  if (!line.task.array.layout.empty()) {
    cost.seconds += host_pair_s * transducers(line.task.array.layout) * foci * turns_of(line.task.array.drive);
  }
  if (line.task.felt.spectrum) cost.seconds += felt_s;
  if (line.task.touch.tune) cost.seconds += 10 * felt_s;
  return cost;
}

Cost Estimator::of(const setup::DriveLine& line) {
  const double sources = transducers(line.task.layout);
  const auto foci = static_cast<double>(std::max<std::size_t>(1, line.task.foci.size()));
  Cost cost{drive_s + host_pair_s * sources * foci * (turns_of(line.task.drive) + draws_of(line.task.spread)), 0};
  if (line.task.mesh.empty()) return cost;
  const double skin = faces(line.task.mesh);
  return plus(plus(cost, operator_cost(skin)), {skin_pair_s * sources * skin * foci, skin * face_bytes});
}

Cost Estimator::of(const setup::FieldLine& line) {
  const setup::PlaceOptions& place = line.task.place;
  const double samples = place.plane             ? samples_of_plane(place)
                         : !place.points.empty() ? points(place.points)
                                                 : place.samples.value_or(1000);
  const double sources = transducers(line.task.layout), draws = draws_of(line.task.spread);
  const auto foci = static_cast<double>(line.task.foci.size());
  return {drive_s + pair_s * samples * sources * (1 + draws) + host_pair_s * sources * foci * turns_of(line.task.drive),
          samples * (160 + 4 * draws)};
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
  Cost cost = plus(operator_cost(skin), {simulate_s + skin_pair_s * sources * skin * sounds, skin * face_bytes});
  if (skin > most_dense_faces) cost.seconds += fast_solve_s_per_face * skin * sounds;
  cost.seconds += host_pair_s * sources * foci * (turns_of(line.task.drive) - 1);
  cost.seconds += model_s_per_mb * megabytes(line.scene);
  if (!setup::asks_for_finger(line.task.drive).empty()) cost.seconds += skin_pair_s * sources * skin;
  if (line.task.in_time.spectrum) cost.seconds += felt_s * 10;
  if (line.task.touch.tune) cost.seconds += felt_s * 40;
  return cost;
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

double Estimator::megabytes(const std::string& file) {
  std::error_code fault;
  const auto bytes = std::filesystem::file_size(file, fault);
  return fault ? 0 : static_cast<double>(bytes) / 1e6;
}

}  // namespace palpa::sweep
