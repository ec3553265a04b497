#include "gpu/push.hpp"

#include <fmt/core.h>

#include "base/error.hpp"

namespace palpa::gpu {

void check_push_bytes(const std::string& pipeline, std::uint32_t expected, const Push& push) {
  if (push.bytes() == expected) return;
  throw failure(fmt::format("pipeline '{}' was given {} bytes of push constants: its shader has {}", pipeline,
                            push.bytes(), expected));
}

}  // namespace palpa::gpu
