// Reads back from a SPIR-V module what the C++ side believes about it: bindings, workgroup size, member offsets.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpa::test {

struct SpirvStruct {
  std::map<std::string, std::uint32_t> offsets;  ///< member name -> bytes
};

struct SpirvModule {
  std::array<std::uint32_t, 3> local_size{};
  std::vector<std::uint32_t> bindings;                 ///< ascending
  std::map<std::string, SpirvStruct> structs;          ///< by GLSL name
  std::map<std::string, std::uint32_t> array_strides;  ///< struct name -> stride of arrays of it
};

/// Throws std::runtime_error on words that are no SPIR-V module.
SpirvModule read_spirv(std::span<const std::uint32_t> words);

}  // namespace palpa::test
