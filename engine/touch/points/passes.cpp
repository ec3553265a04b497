#include "touch/points/passes.hpp"

namespace palpa::touch {

Passes::Passes(const gpu::Device& device) : device_(device), skin_(device), contacts_(device), clusters_(device) {}

void Passes::prepare(const PreparedSolids& solids, const sensing::RayTables& tables, const StageSetting& setting) {
  const std::scoped_lock lock(making_);
  if (!tables.cameras.empty()) skin_.prepare(tables, !setting.surroundings.empty());
  contacts_.prepare(solids, setting.parameters);
  clusters_.prepare(setting.parameters);
}

}  // namespace palpa::touch
