// What this process may still have of memory by its limits: those of its shell (ulimit) and of its control group.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace palpa {

inline constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

/// Bytes of addresses that `ulimit -v` and `ulimit -d` leave: also those count that are reserved and never used.
std::uint64_t addresses_left();

/// Bytes that the control group leaves, and each group around it (cgroup v2, or v1's memory controller). What the
/// kernel keeps of files does not count, since it gives that back.
std::uint64_t group_memory_left();
/// The same from elsewhere: `groups` is what /proc/self/cgroup says, `root` where control groups are mounted.
std::uint64_t group_memory_left(const std::string& groups, const std::filesystem::path& root);

}  // namespace palpa
