// Contacts: the skin points in the shell of a solid, Eq. (1) of the paper.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scan.hpp"
#include "gpu/timestamps.hpp"
#include "sensing/skin.hpp"
#include "touch/scene_table.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of ContactsPass, in the same single-precision arithmetic, so the same contacts with the same depths: fills
/// `out.contacts` and, where asked for, `out.deep`. A contact lies strictly inside a solid and nearer than its delta to
/// its surface; it belongs to the first solid for which that is so. A point that is no contact is a deep point of the
/// first solid that it lies inside of. Points with a coordinate that is not finite are neither. Of convex solids the
/// twin asks every plane; the pass asks those of a cell. Agrees with double precision except within 1 micrometre of a
/// boundary (solids up to 3 m).
void find_contacts(std::span<const sensing::SkinPoint> points, const SceneTable& table, const Parameters& parameters,
                   Touch& out);

/// The scene's surfaces on the device, as ContactsPass binds them: with views of texels, see surface_tables.hpp.
struct SurfaceBuffers {
  gpu::BufferRef cells;      ///< shader::SurfaceCell[], R32G32_UINT
  gpu::BufferRef runs;       ///< uint[], R32_UINT
  gpu::BufferRef triangles;  ///< shader::SurfaceTriangle[], R32G32B32A32_SFLOAT
  gpu::BufferRef signs;      ///< shader::SurfaceSigns[], R32G32B32A32_UINT
  gpu::BufferRef corners;    ///< vec4[], R32G32B32A32_SFLOAT
};

/// What the pass reads and writes. `most_points` and `most_contacts` are the room in the buffers.
struct ContactsBuffers {
  gpu::BufferRef points;  ///< in: vec4 per skin point: x, y, z, the bits of its index
  gpu::BufferRef length;  ///< in: shader::ScanTotal of the points, 64 per group
  gpu::BufferRef solids;  ///< in: shader::SolidRecord[]
  gpu::BufferRef cells;   ///< in: shader::PlaneCell[]
  gpu::BufferRef planes;  ///< in: vec4[]
  gpu::BufferRef hits;    ///< scratch: 8 bytes per point
  gpu::BufferRef masks;   ///< scratch: mask_words(most_points) words
  gpu::BufferRef counts;  ///< scratch: shader::contacts_chunks words
  /// out: shader::ScanTotal: contacts found, also those for which there was no room; its groups are those of the passes
  /// over contacts, shader::contact_group each, at least one and at most shader::contacts_most_groups
  gpu::BufferRef total;
  gpu::BufferRef contacts;        ///< out: shader::ContactRecord[], in input order, `finger` unset
  std::uint32_t most_points = 0;  ///< at most shader::contacts_most_points
  std::uint32_t most_contacts = 0;
  // Only where a solid is asked by its surface or by its parts; all of them then, be they empty.
  SurfaceBuffers surface = {};  ///< in
  gpu::BufferRef parts = {};    ///< in: SceneTable::parts, uvec4[], with a view of R32G32B32A32_UINT texels
  // Only where deep points are asked for; sizes as of their counterparts above.
  gpu::BufferRef deep_masks = {}, deep_counts = {};  ///< scratch
  gpu::BufferRef deep_total = {};                    ///< out: shader::ScanTotal
  gpu::BufferRef deep = {};                          ///< out: shader::ContactRecord[]
  std::uint32_t most_deep = 0;
};

/// Words of 32 points that the pass's chunks cover.
std::uint32_t mask_words(std::uint32_t points);

/// Pipelines only; two dispatches: find, pack; three with deep points. Points beyond `most_points` and contacts beyond
/// `most_contacts` are left out; `length` and `total` tell.
class ContactsPass {
 public:
  explicit ContactsPass(const gpu::Device& device);

  /// Barriers: expects points and length to be visible to compute; adds its own inside; the
  /// caller adds compute_to_compute afterwards.
  /// With `times`, marks "contacts find" and "contacts pack".
  void record(VkCommandBuffer commands, const ContactsBuffers& buffers, const SceneTable& table,
              const Parameters& parameters, gpu::Timestamps* times = nullptr) const;

 private:
  struct Kernels {
    gpu::ComputePipeline planes, surface, parts;
  };
  std::array<std::array<Kernels, 2>, 2> find_;  ///< [one solid][deep points]
  gpu::ComputePipeline pack_;
};

}  // namespace palpa::touch
