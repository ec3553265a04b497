// The solids of a scene on the device, as the passes bind them.
#pragma once

#include "gpu/buffer.hpp"
#include "gpu/texel_view.hpp"
#include "touch/contacts/contacts_pass.hpp"
#include "touch/contacts/prepared_solids.hpp"

namespace palpa::touch {

/// The device tables in which ContactsPass looks up solids that are not convex. They are read as texels because the
/// reads are frequent and scattered.
/// The surfaces of all solids, one after the other with their indices shifted, and their convex parts.
class SurfaceMemory {
 public:
  SurfaceMemory() = default;
  /// Fills host memory; record() copies it to the device. Throws failure if a table is larger than the device can
  /// address.
  SurfaceMemory(const gpu::Device& device, const PreparedSolids& solids);

  void record(VkCommandBuffer commands) const;
  SurfaceBindings surface() const;
  gpu::BufferRef parts() const { return parts_.view.ref(); }

 private:
  /// At least one texel, so that there is something to bind.
  struct Table {
    Table() = default;
    Table(const gpu::Device& device, std::uint64_t bytes, VkFormat format, const char* name);
    gpu::Upload memory;
    gpu::TexelView view;
  };
  void copy(const geometry::Surface& surface, const SurfaceBase& base) const;

  Table cells_, runs_, triangles_, signs_, corners_, parts_;
};

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
