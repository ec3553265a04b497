// Cross-section frames, Eq. (2)-(5), and foci, Eq. (6)-(7), of every finger.
#pragma once

#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "shaders/sections.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of SectionsPass: fills section, foci and point_like of the first `finger_count` fingers from their
/// contacts. Sums run in the pass's order with the same single-precision arithmetic: where a device divides and takes
/// roots exactly, results are the same bit for bit; elsewhere frames differ by some units in the last place, and
/// contacts within 1e-5 rad of a sector's border may change sides.
void find_sections(const Parameters& parameters, Touch& out);

/// Directions of the sectors' borders for every N up to max_foci, as the pass binds them.
std::vector<shader::Border> sector_borders();

struct SectionsBuffers {
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef parents;   ///< in: per contact a number that its cluster alone has
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[]; out: their `finger`
  gpu::BufferRef header;    ///< in: shader::TouchHeader, one group per finger
  gpu::BufferRef fingers;   ///< in: shader::FingerRecord[max_fingers] as FingersPass leaves it; out: frames
  gpu::BufferRef foci;      ///< out: shader::FocusRecord[max_fingers * max_foci]; a point-like finger has one
  gpu::BufferRef borders;   ///< in: sector_borders()
  std::uint32_t most_contacts = 0;
};

/// Pipelines only; one dispatch.
class SectionsPass {
 public:
  explicit SectionsPass(const gpu::Device& device);

  /// Barriers: expects all inputs to be visible to compute and as indirect arguments; the caller adds its own
  /// afterwards.
  void record(VkCommandBuffer commands, const SectionsBuffers& buffers, const Parameters& parameters) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace palpa::touch
