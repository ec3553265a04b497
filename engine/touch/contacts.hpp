// Contacts: the skin points in the shell of a solid, Eq. (1) of the paper.
#pragma once

#include <span>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scan.hpp"
#include "sensing/skin.hpp"
#include "touch/plane_cells.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of ContactsPass: every plane of every solid whose box holds the point, in the same single-precision
/// arithmetic, so the same contacts with the same depths. A contact lies strictly inside all planes and less than
/// `delta_m` below the nearest; it belongs to the first solid for which that is so. Points with a coordinate that is
/// not finite are no contacts. Agrees with double precision except within 1 micrometre of a boundary (solids up to 3
/// m).
void find_contacts(std::span<const sensing::SkinPoint> points, const PlaneTable& table, double delta_m,
                   std::vector<Contact>& out);

/// What the pass reads and writes. `most_points` and `most_contacts` are the room in the buffers.
struct ContactsBuffers {
  gpu::BufferRef points;          ///< in: vec4 per skin point: x, y, z, the bits of its index
  gpu::BufferRef length;          ///< in: shader::ScanTotal of the points, 64 per group
  gpu::BufferRef solids;          ///< in: shader::SolidRecord[]
  gpu::BufferRef cells;           ///< in: shader::PlaneCell[]
  gpu::BufferRef planes;          ///< in: vec4[]
  gpu::BufferRef hits;            ///< scratch: 8 bytes per point, whole groups of 64
  gpu::BufferRef counts;          ///< scratch: 4 bytes per 64 points
  gpu::BufferRef total;           ///< out: shader::ScanTotal: contacts found, also those for which there was no room
  gpu::BufferRef contacts;        ///< out: shader::ContactRecord[], in input order, `finger` unset
  std::uint32_t most_points = 0;  ///< at most 4,194,240
  std::uint32_t most_contacts = 0;
};

/// Pipelines only; three dispatches: find, scan, pack. Points beyond `most_points` and contacts beyond `most_contacts`
/// are left out; `length` and `total` tell.
class ContactsPass {
 public:
  explicit ContactsPass(const gpu::Device& device);

  /// Barriers: expects points and length to be visible to compute and as indirect arguments; adds its own inside; the
  /// caller adds compute_to_compute afterwards.
  void record(VkCommandBuffer commands, const ContactsBuffers& buffers, const PlaneTable& table, double delta_m) const;

 private:
  gpu::ComputePipeline find_, pack_;
  gpu::ScanPass scan_;
};

}  // namespace palpa::touch
