// The exclusive prefix sum in plain C++.
#pragma once

#include <cstdint>
#include <span>

namespace palpa::gpu {

/// C++ twin of ScanPass: replaces each count by the sum of the counts before it and returns the total.
std::uint32_t exclusive_scan(std::span<std::uint32_t> counts);

}  // namespace palpa::gpu
