// The few barriers that the engine's passes need, by name. Global memory barriers: with a handful of dispatches per
// frame a per-buffer barrier would tell the driver nothing more.
//
// Work that is recorded anew into the same buffers begins with one, too. The host has waited on the Timeline before it
// records, which orders the submits; synchronisation validation does not follow waits of the host and would call the
// second use of the buffers a hazard. The barrier costs nothing there: nothing is under way.
#pragma once

#include <volk.h>

namespace palpa::gpu {

/// A dispatch reads (as storage or as indirect arguments) or overwrites what earlier dispatches wrote.
void compute_to_compute(VkCommandBuffer commands);
/// A dispatch uses what a copy or fill wrote; also vertex input and further transfers.
void transfer_to_use(VkCommandBuffer commands);
/// A copy or fill touches what dispatches or copies wrote or read.
void writes_to_transfer(VkCommandBuffer commands);
/// The host reads, after the submit completes, what dispatches or copies wrote.
void writes_to_host(VkCommandBuffer commands);

}  // namespace palpa::gpu
