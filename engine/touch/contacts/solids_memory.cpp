#include "touch/contacts/solids_memory.hpp"

#include "gpu/commands.hpp"

namespace palpa::touch {

SolidsMemory::SolidsMemory(const gpu::Device& device, const PreparedSolids& solids) {
  const gpu::Recorder recorder(device, "solids");
  gpu::Timeline timeline(device, "solids");
  const VkCommandBuffer commands = recorder.begin();
  cells_ = gpu::uploaded(device, commands, std::span(solids.cells), "plane cells");
  planes_ = gpu::uploaded(device, commands, std::span(solids.planes), "planes");
  surfaces_ = SurfaceMemory(device, solids);
  surfaces_.record(commands);
  timeline.wait(timeline.submit(recorder.end()));
}

}  // namespace palpa::touch
