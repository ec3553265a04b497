// Reads back from a SPIR-V module what the C++ side assumes about it: bindings, workgroup size, member offsets; and
// what it reads and writes.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gpu/kernel.hpp"

namespace palpa::test {

struct SpirvStruct {
  std::map<std::string, std::uint32_t> offsets;  ///< member name -> bytes
};

struct SpirvBinding {
  std::uint32_t number = 0;
  std::string name;  ///< of a block, its own name; of a texel buffer, the variable's
  bool texels = false;
};

struct SpirvModule {
  std::array<std::uint32_t, 3> local_size{};
  std::vector<SpirvBinding> bindings;                  ///< in ascending order of number; two blocks may share a number
  std::map<std::string, SpirvStruct> structs;          ///< by GLSL name
  std::map<std::string, std::uint32_t> array_strides;  ///< struct name -> stride of arrays of it
};

/// Throws std::runtime_error if the words are not a SPIR-V module.
SpirvModule read_spirv(std::span<const std::uint32_t> words);
/// Also throws std::runtime_error if the build's table does not have the module's bindings, by number, name and kind.
SpirvModule read_spirv(const gpu::Kernel& kernel);

/// What a kernel does with a buffer that it binds.
struct Access {
  bool reads = false, writes = false, adds = false;  ///< `adds`: by atomic operations
  bool operator==(const Access&) const = default;
};

/// How the kernel uses each of its bindings, from its SPIR-V.
std::vector<Access> accesses_of(const gpu::Kernel& kernel);

}  // namespace palpa::test
