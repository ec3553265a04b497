#include "touch/sections/sections_pass.hpp"

#include "gpu/barrier.hpp"
#include "shaders/shared/scan.h"
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/sections/sections.h"
#include "spirv/sections_axes.comp.hpp"
#include "spirv/sections_count.comp.hpp"
#include "spirv/sections_group.comp.hpp"

namespace palpa::touch {

static_assert(shader::sections_most_chunks * shader::sections_groups_per_chunk >= shader::contacts_most_groups);
static_assert(shader::sections_table >= 2 * shader::fingers_most);

namespace {
/// The buffers that the kernels bind, by name: those of the caller and the scratch.
struct Buffers : SectionsBindings {
  gpu::BufferRef counts = {};
};
}  // namespace

SectionsPass::SectionsPass(const gpu::Device& device)
    : count_(device, "sections count", spirv::sections_count_comp, sizeof(shader::SectionsPush)),
      group_(device, "sections group", spirv::sections_group_comp, sizeof(shader::SectionsPush)),
      axes_(device, "sections axes", spirv::sections_axes_comp, 0) {}

std::vector<gpu::ScratchBuffer> SectionsPass::scratch() {
  std::vector<gpu::ScratchBuffer> list(scratch_count);
  list[counts] = {"finger counts", std::uint64_t{shader::sections_most_chunks} * shader::fingers_most * 4};
  return list;
}

void SectionsPass::record(VkCommandBuffer commands, const SectionsBindings& b, const gpu::Scratch& s, const Room& room,
                          gpu::Timestamps* times) const {
  const shader::SectionsPush push{room.contacts, 0, 0, 0};
  Buffers buffers{b};
  buffers.counts = s[counts];
  const gpu::BufferRef chunks = gpu::groups_in(b.total, offsetof(shader::ScanTotal, groups_x));
  count_.dispatch_indirect(commands, spirv::sections_count_buffers(buffers), push, chunks);
  if (times) times->mark(commands, "count");
  gpu::compute_to_compute(commands);
  group_.dispatch_indirect(commands, spirv::sections_group_buffers(buffers), push, chunks);
  if (times) times->mark(commands, "group");
  gpu::compute_to_compute(commands);
  axes_.dispatch_indirect(commands, spirv::sections_axes_buffers(buffers), gpu::Push::none(), gpu::groups_in(b.header));
  if (times) times->mark(commands, "sections");
}

}  // namespace palpa::touch
