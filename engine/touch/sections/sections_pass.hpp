// Cross-sections of every finger, Eq. (2)-(4), on the device.
#pragma once

#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "gpu/timestamps.hpp"
#include "touch/room.hpp"

namespace palpa::touch {

struct SectionsBindings {
  // `contacts` and `grouped` have a view of R32G32B32A32_UINT texels.
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef parents;   ///< in: per contact, a number that is unique to its finger
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[]; out: their `finger`
  gpu::BufferRef header;    ///< in: shader::TouchHeader, one group per finger
  gpu::BufferRef grouped;   ///< out: uvec4 per contact: bits of x, y, z and depth; in order, finger after finger
  gpu::BufferRef fingers;   ///< in: shader::FingerRecord[max_fingers] as FingersPass leaves it; out: cross-sections
};

/// Pipelines only; three dispatches: count, group and axes. count and group sort the contacts by finger; their cost
/// does not depend on the number of fingers. axes processes the contacts of each finger.
class SectionsPass {
 public:
  explicit SectionsPass(const gpu::Device& device);

  static std::vector<gpu::ScratchBuffer> scratch();

  /// Barriers: all inputs must be visible to compute and as indirect arguments. Adds the inner barriers itself; the
  /// caller adds compute_to_compute afterwards. With `times`, marks "count", "group" and "sections".
  void record(VkCommandBuffer commands, const SectionsBindings& bindings, const gpu::Scratch& scratch, const Room& room,
              gpu::Timestamps* times = nullptr) const;

 private:
  enum ScratchIndex : std::size_t { counts, scratch_count };

  gpu::ComputePipeline count_, group_, axes_;
};

}  // namespace palpa::touch
