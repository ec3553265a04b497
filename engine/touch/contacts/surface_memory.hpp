// The device tables in which ContactsPass looks up solids that are not convex. They are read as texels because the
// reads are frequent and scattered.
#pragma once

#include "gpu/buffer.hpp"
#include "gpu/texel_view.hpp"
#include "touch/contacts/contacts_pass.hpp"
#include "touch/contacts/prepared_solids.hpp"

namespace palpa::touch {

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

}  // namespace palpa::touch
