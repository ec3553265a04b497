// Lets one header describe a struct to both GLSL (std430) and C++. Use only `uint`, `int`, `float`, `vec4` and `uvec4`
// members, and structs and arrays of these. Pad a struct with such a vector to a multiple of 16 bytes. Both sides then
// agree without padding rules.
#ifndef PALPA_SHADERS_SHARED_H
#define PALPA_SHADERS_SHARED_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#define PALPA_SHADER_BEGIN namespace palpa::shader {
#define PALPA_SHADER_END }
#define PALPA_CONST inline constexpr std::uint32_t
#define PALPA_CONST_FLOAT inline constexpr float
#define PALPA_FN inline
#define PALPA_FN_INLINED [[gnu::always_inline]] inline  // for loops over lanes
// Size and offsets are checked on the C++ side; a test reads the same numbers back from the SPIR-V.
#define PALPA_CHECK_SIZE(type, bytes) static_assert(sizeof(type) == (bytes), #type " differs from its shader")
#define PALPA_CHECK_OFFSET(type, member, bytes) \
  static_assert(offsetof(type, member) == (bytes), #type "::" #member " differs from its shader")
namespace palpa::shader {
using uint = std::uint32_t;
struct alignas(16) vec4 {
  float x, y, z, w;
};
struct alignas(16) uvec4 {
  uint x, y, z, w;
};
}  // namespace palpa::shader
#else
#define PALPA_SHADER_BEGIN
#define PALPA_SHADER_END
#define PALPA_CONST const uint
#define PALPA_CONST_FLOAT const float
#define PALPA_FN
#define PALPA_FN_INLINED
#define PALPA_CHECK_SIZE(type, bytes)
#define PALPA_CHECK_OFFSET(type, member, bytes)
#endif

#endif
