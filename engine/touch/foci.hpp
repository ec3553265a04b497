// Foci of every finger, Eq. (5)-(7), or at equal arc lengths along its cross-section.
#pragma once

#include <span>
#include <vector>

#include "geometry/solid.hpp"
#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "shaders/foci.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// N of each solid's fingers where its model says one (1 to max_foci), else 0: the parameters' N. Throws bad_usage
/// naming the solid for another number.
std::vector<std::uint32_t> foci_of_solids(const std::vector<geometry::Solid>& solids);

/// C++ twin of FociPass: fills the foci of the first `finger_count` fingers from contacts and sections. A solid beyond
/// `of_solid` has the parameters' N. The same single-precision arithmetic as in the pass and sums in integers: where a
/// device divides and takes roots exactly, results are the same bit for bit; elsewhere contacts within 1e-5 rad of a
/// sector's border may change sides.
void find_foci(const Parameters& parameters, std::span<const std::uint32_t> of_solid, Touch& out);

/// Directions of equally wide sectors' borders for every N up to max_foci, as the pass binds them.
std::vector<shader::Border> sector_borders();

struct FociBuffers {
  gpu::BufferRef grouped;   ///< in: contacts in order of their fingers, from FramesPass
  gpu::BufferRef header;    ///< in: shader::TouchHeader, one group per finger
  gpu::BufferRef fingers;   ///< in: shader::FingerRecord[max_fingers] with frames; out: number of foci
  gpu::BufferRef foci;      ///< out: shader::FocusRecord[max_fingers * max_foci]; a point-like finger has one
  gpu::BufferRef borders;   ///< in: sector_borders()
  gpu::BufferRef of_solid;  ///< in: foci_of_solids(), one uint per solid
};

/// Pipelines only; one dispatch.
class FociPass {
 public:
  explicit FociPass(const gpu::Device& device);

  /// Barriers: expects all inputs to be visible to compute and as indirect arguments; the caller adds its own
  /// afterwards.
  void record(VkCommandBuffer commands, const FociBuffers& buffers, const Parameters& parameters) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace palpa::touch
