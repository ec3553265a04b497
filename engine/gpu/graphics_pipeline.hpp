// A pipeline that draws triangles whose vertices the shader fetches from storage buffers, without vertex input or
// descriptor pools. State that changes from draw to draw (culling, depth) is dynamic, so that a handful of pipelines
// draw everything.
#pragma once

#include <volk.h>

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

#include "gpu/buffer.hpp"
#include "gpu/buffer_set.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"
#include "gpu/push.hpp"

namespace palpa::gpu {

struct GraphicsLayout {
  std::uint32_t buffers = 0;     ///< read-only storage buffers at set 0, bindings 0..buffers-1
  std::uint32_t push_bytes = 0;  ///< push constant block of both stages, a multiple of 4, at most 128
  VkFormat colour = VK_FORMAT_UNDEFINED;
  VkFormat depth = VK_FORMAT_UNDEFINED;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  bool blend = false;        ///< source over destination, by the fragment's alpha
  bool writes_alpha = true;  ///< false if a fragment's alpha has another meaning than the image's opacity
};

/// How one draw treats faces and depth.
struct DrawState {
  VkCullModeFlags cull = VK_CULL_MODE_NONE;  ///< front faces are counter-clockwise as seen in the image
  bool depth_test = true;
  bool depth_write = false;
  VkCompareOp compare = VK_COMPARE_OP_GREATER_OR_EQUAL;  ///< depth runs from 1 (near) to 0 (far)
};

class GraphicsPipeline {
 public:
  GraphicsPipeline() = default;
  /// `vertex` and `fragment` are arrays of namespace palpa::spirv; the entry points are main. Without a fragment
  /// shader, it draws only depth.
  GraphicsPipeline(const Device& device, const char* name, std::span<const std::uint32_t> vertex,
                   std::span<const std::uint32_t> fragment, const GraphicsLayout& layout);

  /// Call inside a rendering with the layout's formats and samples, with viewport and scissor set. `buffers` are in
  /// binding order; gl_VertexIndex counts from `first`. Records nothing if `vertices` is 0. Throws failure if the
  /// number of buffers or the size of the push constants differs from the layout's.
  void draw(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push,
            const DrawState& state, std::uint32_t vertices, std::uint32_t first = 0) const;
  /// The same for indexed vertices, given as a run of `indices` (32 bits each); gl_VertexIndex is the index.
  struct Run {
    BufferRef indices;
    std::uint32_t first = 0, count = 0;
  };
  void draw(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push,
            const DrawState& state, const Run& run) const;

 private:
  void bind(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push,
            const DrawState& state) const;

  std::string name_;
  BufferSet set_;
  Handle<VkPipelineLayout> layout_;
  Handle<VkPipeline> pipeline_;
  std::uint32_t push_bytes_ = 0;
};

}  // namespace palpa::gpu
