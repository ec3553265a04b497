// Data that the build extracts from a compiled compute shader. With it, a pass assigns buffers by the names in the
// shader instead of their order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "gpu/buffer.hpp"

namespace palpa::gpu {

inline constexpr std::size_t most_kernel_buffers = 17;

struct KernelBinding {
  const char* name = "";
  bool texels = false;  ///< a uniform texel buffer; otherwise a storage buffer
};

/// A compute shader: `palpa::spirv::NAME_comp` of the header "spirv/NAME.comp.hpp", which the build generates.
struct Kernel {
  const char* name = "";  ///< the shader's file without its extension
  std::span<const std::uint32_t> words = {};
  std::span<const KernelBinding> bindings = {};  ///< element i is binding i of set 0; at most most_kernel_buffers
};

/// The buffers for one dispatch of a kernel. `palpa::spirv::NAME_buffers(from)`, in the same header, makes it. `from`
/// is any struct with a BufferRef under the name of each of the kernel's bindings; if one is missing, it does not
/// compile.
struct KernelBuffers {
  const Kernel* kernel = nullptr;
  std::array<BufferRef, most_kernel_buffers> refs = {};  ///< element i is bound at binding i
};

}  // namespace palpa::gpu
