// The solids of a scene on the device, as the passes bind them.
#pragma once

#include "gpu/buffer.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/contacts/surface_memory.hpp"

namespace palpa::touch {

/// Written once, read by every frame. The poses of the solids are uploaded with each frame.
class SolidsMemory {
 public:
  /// Uploads and waits. Throws failure if a buffer would be larger than the device allows.
  SolidsMemory(const gpu::Device& device, const PreparedSolids& solids);

  const SurfaceMemory& surfaces() const { return surfaces_; }
  gpu::BufferRef cells() const { return cells_.ref(); }
  gpu::BufferRef planes() const { return planes_.ref(); }

 private:
  gpu::Upload cells_, planes_;
  SurfaceMemory surfaces_;
};

}  // namespace palpa::touch
