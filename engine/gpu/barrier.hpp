// The few barriers that the engine's passes need, by name. All are global memory barriers: with a handful of dispatches
// per frame, per-buffer barriers would tell the driver nothing more.
//
// Command buffers that reuse the same buffers also begin with a barrier. The host waits on the Timeline before it
// records, which orders the submits. Synchronisation validation does not follow the host's waits, however, and would
// report the second use of the buffers as a hazard. The barrier costs nothing there, because no work is in progress.
#pragma once

#include <volk.h>

namespace palpa::gpu {

/// Between any stages and accesses.
void barrier(VkCommandBuffer commands, VkPipelineStageFlags2 from, VkAccessFlags2 wrote, VkPipelineStageFlags2 to,
             VkAccessFlags2 touches);
/// A dispatch reads (as storage or indirect arguments) or overwrites data that earlier dispatches wrote.
void compute_to_compute(VkCommandBuffer commands);
/// A dispatch uses data that a copy or fill wrote; also covers vertex input and further transfers.
void transfer_to_use(VkCommandBuffer commands);
/// A copy or fill touches data that dispatches or copies wrote or read.
void writes_to_transfer(VkCommandBuffer commands);
/// After the submit completes, the host reads data that dispatches or copies wrote.
void writes_to_host(VkCommandBuffer commands);

}  // namespace palpa::gpu
