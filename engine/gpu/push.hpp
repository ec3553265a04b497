// Push constants for a shader: the struct that a pass and its shader share.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>

namespace palpa::gpu {

/// Refers to the struct during one call. Pipelines reject a size other than their shader's.
class Push {
 public:
  /// For shaders without push constants.
  static Push none() { return {nullptr, 0}; }

  // Implicit on purpose: callers pass the struct itself to a dispatch.
  template <typename T>
  requires std::is_class_v<T> Push(const T& value) : Push(&value, sizeof(T)) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0 && sizeof(T) <= 128);
  }

  const void* data() const { return data_; }
  std::uint32_t bytes() const { return bytes_; }

 private:
  Push(const void* data, std::uint32_t bytes) : data_(data), bytes_(bytes) {}

  const void* data_;
  std::uint32_t bytes_;
};

/// Throws failure unless `push` has the size that the pipeline's shader expects.
void check_push_bytes(const std::string& pipeline, std::uint32_t expected, const Push& push);

}  // namespace palpa::gpu
