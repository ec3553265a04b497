#include "touch/passes.hpp"

namespace palpa::touch {

Passes::Passes(const gpu::Device& device)
    : device_(device), skin_(device), contacts_(device), fingers_(device), sections_(device), foci_(device) {}

void Passes::prepare(const PreparedSolids& solids, const sensing::RayTables& tables, const StageSetting& setting) {
  const std::scoped_lock lock(making_);
  if (!tables.cameras.empty()) skin_.prepare(tables, !setting.surroundings.empty());
  contacts_.prepare(solids, setting.parameters);
  fingers_.prepare(setting.parameters);
  if (setting.looks_again(!tables.cameras.empty())) {
    if (!split_) split_.emplace(device_);
    if (!bridge_) bridge_.emplace(device_);
  }
  if (setting.knows(!tables.cameras.empty()) && !known_) known_.emplace(device_);
  if (setting.follow && !follow_) follow_.emplace(device_);
  if (setting.glides() && !glide_) glide_.emplace(device_);
}

}  // namespace palpa::touch
