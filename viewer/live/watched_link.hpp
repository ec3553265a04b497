// A link that says what passes through it: what the array does at this moment, without asking the array.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "session/links/link.hpp"

namespace palpa::viewer {

/// Written by the output thread alone.
struct LinkWatch {
  std::atomic<bool> open{false};
  std::atomic<bool> sounding{false};  ///< the last drive was not silence
  std::atomic<std::uint64_t> drives{0}, silent{0};
};

/// The same kinds; what they open is watched by `watch`, which outlives it.
std::vector<session::LinkKind> watched(std::span<const session::LinkKind> kinds, LinkWatch& watch);

}  // namespace palpa::viewer
