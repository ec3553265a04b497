// Contacts on the device: the skin points in the shell of a solid, Eq. (1) of the paper.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "gpu/timestamps.hpp"
#include "shaders/shared/scan.h"
#include "shaders/touch/contacts/reach.h"
#include "touch/capacity.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The scene's surfaces on the device, with texel views (solids_memory.hpp).
struct SurfaceBindings {
  gpu::BufferRef cells;      ///< shader::SurfaceCell[], R32G32_UINT
  gpu::BufferRef runs;       ///< uint[], R32_UINT
  gpu::BufferRef triangles;  ///< shader::SurfaceTriangle[], R32G32B32A32_SFLOAT
  gpu::BufferRef signs;      ///< shader::SurfaceSigns[], R32G32B32A32_UINT
  gpu::BufferRef corners;    ///< vec4[], R32G32B32A32_SFLOAT
};

struct ContactsBindings {
  gpu::BufferRef points;  ///< in: vec4 per skin point: x, y, z, the bits of its index
  gpu::BufferRef length;  ///< in: shader::ScanTotal of the points, divided as groups() says
  gpu::BufferRef solids;  ///< in: shader::SolidRecord[]
  gpu::BufferRef cells;   ///< in: shader::PlaneCell[]
  gpu::BufferRef planes;  ///< in: vec4[]
  /// out: shader::ScanTotal: the contacts found, including those for which there was no room. Its groups are those of
  /// the passes over contacts: shader::contact_group each, at least one and at most shader::contacts_most_groups
  gpu::BufferRef total;
  gpu::BufferRef contacts;  ///< out: shader::ContactRecord[capacity.contacts], in input order
  // Needed only if a solid is looked up by its surface or its parts; then all of them are bound, even empty ones.
  SurfaceBindings surface = {};  ///< in
  gpu::BufferRef parts = {};     ///< in: PreparedSolids::parts, uvec4[], with a view of R32G32B32A32_UINT texels
  // Needed only if deep points are requested.
  gpu::BufferRef deep_total = {};  ///< out: shader::ScanTotal
  gpu::BufferRef deep = {};        ///< out: shader::ContactRecord[capacity.deep]
  /// in: shader::ReachTable. Needed only if fingers of the frame before reach beyond the shell's edges.
  gpu::BufferRef reach = {};
};

/// Pipelines only; two dispatches: find, pack; three with deep points. Points beyond `capacity.points` and contacts
/// beyond `capacity.contacts` are left out; `length` and `total` report how many there were.
class ContactsPass {
 public:
  explicit ContactsPass(const gpu::Device& device) : device_(&device) {}

  /// Makes the pipelines that record() uses for these arguments; existing pipelines are kept. `solids` may move
  /// afterwards. Throws bad_input with the solids' file (bad_usage if there is no file) if there are too many solids
  /// for a device that counts a kernel's iterations.
  void prepare(const PreparedSolids& solids, const FingerOptions& parameters);

  static std::vector<gpu::ScratchBuffer> scratch(const Capacity& capacity);

  /// How to divide the points so that no thread exceeds the limit of a device that counts iterations.
  static shader::ScanGroups groups(const gpu::Device& device, const Capacity& capacity, const PreparedSolids& solids);

  /// Barriers: points and length must be visible to compute, and length also as indirect arguments. Adds the inner
  /// barriers itself; the caller adds compute_to_compute afterwards. With `times`, marks "contacts find" and "contacts
  /// pack". `elapsed_us`: from the frame before to this one; reach_none if `reach` is not to be read.
  void record(VkCommandBuffer commands, const ContactsBindings& bindings, const gpu::Scratch& scratch,
              const Capacity& capacity, const PreparedSolids& solids, const FingerOptions& parameters,
              gpu::Timestamps* times = nullptr, std::uint32_t elapsed_us = shader::reach_none) const;

 private:
  enum ScratchIndex : std::size_t { hits, masks, counts, deep_masks, deep_counts, scratch_count };
  /// The kernels that look points up: by planes only, by planes or surfaces, by any form.
  enum Kernel : std::size_t { by_planes, by_surface, by_parts, kernels };
  static Kernel kernel_for(const PreparedSolids& solids);

  const gpu::Device* device_;
  gpu::ComputePipeline find_[kernels][2][2];  ///< [kernel][one solid][deep points]
  gpu::ComputePipeline pack_;
};

}  // namespace palpa::touch
