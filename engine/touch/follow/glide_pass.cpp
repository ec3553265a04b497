#include "touch/follow/glide_pass.hpp"

#include "spirv/glide.comp.hpp"

namespace palpa::touch {

static_assert(shader::glide_group == shader::foci_most);

GlidePass::GlidePass(const gpu::Device& device) : pipeline_(device, "glide", spirv::glide_comp, 0) {}

void GlidePass::record(VkCommandBuffer commands, const GlideBindings& b) const {
  pipeline_.dispatch_indirect(commands, spirv::glide_buffers(b), gpu::Push::none(), gpu::groups_in(b.header));
}

}  // namespace palpa::touch
