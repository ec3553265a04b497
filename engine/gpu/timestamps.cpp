#include "gpu/timestamps.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "gpu/check.hpp"

namespace palpa::gpu {

Timestamps::Timestamps(const Device& device, std::uint32_t most_marks) : device_(&device), ticks_(most_marks + 1) {
  VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = most_marks + 1;
  VkQueryPool pool = VK_NULL_HANDLE;
  PALPA_VK(vkCreateQueryPool(device.get(), &info, nullptr, &pool));
  pool_ = Handle<VkQueryPool>(device.get(), pool, vkDestroyQueryPool);
  names_.reserve(most_marks);
}

void Timestamps::begin(VkCommandBuffer commands) {
  names_.clear();
  vkResetQueryPool(device_->get(), pool_.get(), 0, static_cast<std::uint32_t>(ticks_.size()));
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_.get(), 0);
}

void Timestamps::mark(VkCommandBuffer commands, const char* name) {
  assert(names_.size() + 1 < ticks_.size());
  names_.push_back(name);
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_.get(),
                       static_cast<std::uint32_t>(names_.size()));
}

void Timestamps::read(std::vector<PassTime>& out) const {
  out.clear();
  const std::uint32_t count = static_cast<std::uint32_t>(names_.size()) + 1;
  PALPA_VK(vkGetQueryPoolResults(device_->get(), pool_.get(), 0, count, count * sizeof(std::uint64_t), ticks_.data(),
                                 sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const std::uint64_t ticks = (ticks_[i + 1] - ticks_[i]) & device_->timestamp_mask();
    const double ms = static_cast<double>(ticks) * device_->limits().timestampPeriod * 1e-6;
    const auto same = std::find_if(out.begin(), out.end(),
                                   [&](const PassTime& pass) { return std::strcmp(pass.name, names_[i]) == 0; });
    if (same != out.end()) {
      same->ms += ms;
    } else {
      out.push_back({names_[i], ms});
    }
  }
}

}  // namespace palpa::gpu
