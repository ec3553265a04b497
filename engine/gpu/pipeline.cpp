#include "gpu/pipeline.hpp"

#include <fmt/core.h>

#include <memory>
#include <vector>

#include "base/error.hpp"
#include "gpu/check.hpp"
#include "gpu/watch.hpp"

namespace palpa::gpu {
namespace {
// Far more than the number of dispatches with one pipeline in two frames.
constexpr std::uint32_t most_in_flight = 512;

/// Bit i is set if binding i is read as texels.
std::uint32_t texels_of(const Kernel& kernel) {
  std::uint32_t texels = 0;
  for (std::size_t i = 0; i < kernel.bindings.size(); ++i)
    texels |= (kernel.bindings[i].texels ? 1U : 0U) << i;
  return texels;
}

}  // namespace

ComputePipeline::ComputePipeline(const Device& device, const char* name, const Kernel& kernel, std::size_t push_bytes,
                                 std::span<const std::uint32_t> constants)
    : name_(name), kernel_(&kernel), push_bytes_(static_cast<std::uint32_t>(push_bytes)) {
  if (!device.keeps_pipelines()) {
    made_ = make(device, name, constants);
    return;
  }
  const PipelineKey key{&kernel, push_bytes_, {constants.begin(), constants.end()}};
  made_ = std::static_pointer_cast<const Made>(
      device.kept_pipeline(key, [&] { return std::shared_ptr<const void>(make(device, name, constants)); }));
}

Handle<VkShaderModule> make_shader_module(const Device& device, std::span<const std::uint32_t> words) {
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = words.size_bytes();
  info.pCode = words.data();
  VkShaderModule module = VK_NULL_HANDLE;
  PALPA_VK(vkCreateShaderModule(device.get(), &info, nullptr, &module));
  return {device.get(), module, vkDestroyShaderModule};
}

std::shared_ptr<const ComputePipeline::Made> ComputePipeline::make(const Device& device, const char* name,
                                                                   std::span<const std::uint32_t> constants) const {
  const Kernel& kernel = *kernel_;
  auto made = std::make_shared<Made>();
  made->set = BufferSet(device, name, static_cast<std::uint32_t>(kernel.bindings.size()), VK_SHADER_STAGE_COMPUTE_BIT,
                        most_in_flight, texels_of(kernel));
  made->layout = made->set.pipeline_layout(device, push_bytes_);
  const Handle<VkShaderModule> module = make_shader_module(device, kernel.words);

  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) {
    entries.push_back({i, static_cast<std::uint32_t>(i * sizeof(std::uint32_t)), sizeof(std::uint32_t)});
  }
  const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            constants.size_bytes(), constants.data()};
  VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = module.get();
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = entries.empty() ? nullptr : &specialization;
  create.layout = made->layout.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  PALPA_VK(vkCreateComputePipelines(device.get(), VK_NULL_HANDLE, 1, &create, nullptr, &pipeline));
  ++device.pipelines_created;
  made->pipeline = Handle<VkPipeline>(device.get(), pipeline, vkDestroyPipeline);
  device.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), name);
  return made;
}

void ComputePipeline::check(const KernelBuffers& buffers) const {
  if (buffers.kernel != kernel_) {
    throw failure(fmt::format("pipeline '{}' was given the buffers of kernel '{}': its own is '{}'", name_,
                              buffers.kernel ? buffers.kernel->name : "", kernel_->name));
  }
  for (std::size_t i = 0; i < kernel_->bindings.size(); ++i) {
    const KernelBinding& binding = kernel_->bindings[i];
    if (binding.texels ? buffers.refs[i].texels != VK_NULL_HANDLE : buffers.refs[i].buffer != VK_NULL_HANDLE) continue;
    throw failure(fmt::format("pipeline '{}' was given no {} as '{}'", name_, binding.texels ? "texels" : "buffer",
                              binding.name));
  }
}

void ComputePipeline::bind(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push) const {
  if (!made_) throw failure("a pipeline that was not made cannot be dispatched: prepare its pass first");
  check_push_bytes(name_, push_bytes_, push);
  check(buffers);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, made_->pipeline.get());
  made_->set.bind(commands, VK_PIPELINE_BIND_POINT_COMPUTE, made_->layout.get(),
                  std::span(buffers.refs).first(kernel_->bindings.size()));
  if (push_bytes_ != 0) {
    vkCmdPushConstants(commands, made_->layout.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes_, push.data());
  }
}

void ComputePipeline::dispatch(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push,
                               std::uint32_t groups_x, std::uint32_t groups_y, std::uint32_t groups_z) const {
  if (groups_x == 0 || groups_y == 0 || groups_z == 0) return;
  bind(commands, buffers, push);
  if (Watch* const sees = watch) sees->dispatches(commands, buffers, nullptr);
  vkCmdDispatch(commands, groups_x, groups_y, groups_z);
}

void ComputePipeline::dispatch_indirect(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push,
                                        BufferRef arguments) const {
  bind(commands, buffers, push);
  if (Watch* const sees = watch) sees->dispatches(commands, buffers, &arguments);
  vkCmdDispatchIndirect(commands, arguments.buffer, arguments.offset);
}

}  // namespace palpa::gpu
