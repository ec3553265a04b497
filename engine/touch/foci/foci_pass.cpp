#include "touch/foci/foci_pass.hpp"

#include "shaders/touch/foci/foci.h"
#include "spirv/foci.comp.hpp"

namespace palpa::touch {

static_assert(max_foci == shader::foci_most);

FociPass::FociPass(const gpu::Device& device) : pipeline_(device, "foci", spirv::foci_comp, sizeof(shader::FociPush)) {}

void FociPass::record(VkCommandBuffer commands, const FociBindings& b, const Parameters& parameters) const {
  const std::uint32_t spacing = parameters.spacing == Spacing::arc ? shader::spacing_arc : shader::spacing_angle;
  const shader::FociPush push{parameters.foci, spacing, 0, 0};
  pipeline_.dispatch_indirect(commands, spirv::foci_buffers(b), push, gpu::groups_in(b.header));
}

}  // namespace palpa::touch
