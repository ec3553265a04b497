#include "gpu/scan_twin.hpp"

namespace palpa::gpu {

std::uint32_t exclusive_scan(std::span<std::uint32_t> counts) {
  std::uint32_t sum = 0;
  for (std::uint32_t& count : counts) {
    const std::uint32_t here = count;
    count = sum;
    sum += here;
  }
  return sum;
}

}  // namespace palpa::gpu
