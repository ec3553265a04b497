// How much memory the limits of this process still allow: those of its shell (ulimit) and of its control group.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace palpa {

inline constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

/// Bytes of address space that `ulimit -v` and `ulimit -d` leave. Reserved but unused addresses count as used.
std::uint64_t addresses_left();

/// Bytes that the control group and all groups around it leave (cgroup v2, or v1's memory controller). The kernel's
/// file cache does not count as used, because the kernel gives it back.
std::uint64_t group_memory_left();
/// The same for other files: `groups` is the text of /proc/self/cgroup, `root` the folder where control groups are
/// mounted.
std::uint64_t group_memory_left(const std::string& groups, const std::filesystem::path& root);

}  // namespace palpa
