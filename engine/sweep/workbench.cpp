#include "sweep/workbench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "setup/load.hpp"
#include "setup/tasks/drive.hpp"
#include "setup/tasks/field.hpp"
#include "setup/tasks/simulate_result.hpp"
#include "setup/tasks/touch.hpp"
#include "setup/touch_input.hpp"

namespace palpa::sweep {
namespace {

/// Models are small beside the matrices of a simulation, but a sweep may have thousands.
constexpr std::size_t most_models = 4;

}  // namespace

Workbench::Workbench(const setup::ComputeOptions& compute) : compute_(compute) {
  compute_.device = setup::kept_device(compute);
}

std::string Workbench::device_name() const {
  if (!compute_.device) return "the processor";
  return fmt::format("{} ({})", compute_.device->description().name, compute_.device->description().driver);
}

std::string Workbench::compute(Line& line) {
  return std::visit([&](auto& of_command) { return compute(of_command); }, line);
}

/// Everything but the seed, which belongs to the case.
void Workbench::set(setup::CommonOptions& common) const {
  const std::uint64_t seed = common.seed;
  static_cast<setup::ComputeOptions&>(common) = compute_;
  common.seed = seed;
}

std::vector<geometry::Solid> Workbench::solids(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene,
                                               const setup::SolidOptions& options) {
  const std::string key =
      fmt::format("{}\n{}\n{}\n{}\n{}", scene, gltf_scene ? fmt::format("{}", *gltf_scene) : "",
                  static_cast<int>(options.surface), options.parts.value_or(0),
                  options.internal_faces ? fmt::format("{}", static_cast<int>(*options.internal_faces)) : "");
  const auto known = std::ranges::find(models_, key, &Model::key);
  if (known != models_.end()) {
    std::rotate(known, known + 1, models_.end());
    return models_.back().solids;
  }
  std::vector<geometry::Solid> loaded = setup::load_solids(scene, gltf_scene, options);
  if (models_.size() == most_models) models_.erase(models_.begin());
  models_.push_back({key, std::move(loaded)});
  return models_.back().solids;
}

setup::FingerBody& Workbench::finger(const std::string& file, const acoustics::Air& air, bool force) {
  const std::string key = fmt::format("{}\n{}\n{}\n{}\n{}\n{}", file, force, air.medium.sound_speed,
                                      air.medium.frequency, air.density_kg_m3, air.absorption_np_m);
  if (!finger_ || finger_->key != key) {
    finger_.reset();  // two of them may not fit into the memory
    finger_ = Finger{key, std::make_unique<setup::FingerBody>(file, air, force)};
  }
  return *finger_->body;
}

std::string Workbench::compute(setup::TouchLine& line) {
  set(line.common);
  settle(line);
  std::vector<geometry::Solid> scene = solids(line.input.scene, line.input.gltf_scene, line.input.solids);
  const setup::TouchInput skin = setup::load_touch_input(line.input, scene);
  return to_json(setup::touch_scene(line.task, line.input.scene, std::move(scene), skin));
}

std::string Workbench::compute(setup::DriveLine& line) {
  set(line.common);
  return to_json(setup::make_drive(line.task, line.common));
}

std::string Workbench::compute(setup::FieldLine& line) {
  set(line.common);
  return to_json(setup::sum_field(line.task, line.common));
}

std::string Workbench::compute(setup::SimulateLine& line) {
  set(line.common);
  settle(line);
  std::vector<geometry::Solid> scene = solids(line.scene, line.gltf_scene, line.solids);
  setup::FingerBody& body = finger(line.finger, setup::air(line.task.drive.medium, line.task.air), line.force);
  return to_json(setup::simulate(line.task, body, line.scene, std::move(scene)));
}

}  // namespace palpa::sweep
