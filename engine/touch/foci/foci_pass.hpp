// Foci of every finger, Eq. (5)-(7), or at equal arc lengths along its cross-section, on the device.
#pragma once

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

struct FociBindings {
  gpu::BufferRef grouped;   ///< in: contacts in order of their fingers, from SectionsPass, with its view
  gpu::BufferRef header;    ///< in: shader::TouchHeader, one group per finger
  gpu::BufferRef fingers;   ///< in: shader::FingerRecord[max_fingers] with cross-sections; out: number of foci
  gpu::BufferRef foci;      ///< out: shader::FocusRecord[max_fingers * max_foci]; a point-like finger has one
  gpu::BufferRef borders;   ///< in: sector_borders()
  gpu::BufferRef of_solid;  ///< in: foci_of_solids(), one uint per solid
};

/// Pipelines only; one dispatch.
class FociPass {
 public:
  explicit FociPass(const gpu::Device& device);

  /// Barriers: all inputs must be visible to compute and as indirect arguments. The caller adds the barriers
  /// afterwards.
  void record(VkCommandBuffer commands, const FociBindings& bindings, const Parameters& parameters) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace palpa::touch
