#include "base/system/memory_limits.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

namespace palpa {
namespace {

std::uint64_t minus(std::uint64_t all, std::uint64_t used) {
  return all - std::min(all, used);
}

/// The number in a file; no_limit if there is no such file or it contains a word ("max").
std::uint64_t number_in(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::uint64_t number = 0;
  return in >> number ? number : no_limit;
}

/// The sum of these keys in a memory.stat.
std::uint64_t sum_of(const std::filesystem::path& stat, const std::string& one, const std::string& other) {
  std::ifstream in(stat);
  std::uint64_t sum = 0, number = 0;
  for (std::string key; in >> key >> number;) {
    if (key == one || key == other) sum += number;
  }
  return sum;
}

struct Names {
  const char *limit, *used, *inactive, *active;
};
constexpr Names version_2{"memory.max", "memory.current", "inactive_file", "active_file"};
constexpr Names version_1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file", "total_active_file"};

/// The memory that the group at `path` below `mount` and its parent groups leave. In a container, the path may be
/// visible only on the host; the container's own group is then the mount itself.
std::uint64_t left_in(const std::filesystem::path& mount, const std::filesystem::path& path, const Names& names) {
  std::error_code fault;
  std::uint64_t left = no_limit;
  for (std::filesystem::path group = mount / path.relative_path();; group = group.parent_path()) {
    const std::uint64_t limit = number_in(group / names.limit);
    // Version 1 expresses "no limit" as a number near the maximum.
    if (limit < no_limit / 4) {
      const std::uint64_t used = number_in(group / names.used);
      const std::uint64_t files = sum_of(group / "memory.stat", names.inactive, names.active);
      if (used != no_limit) left = std::min(left, minus(limit, minus(used, files)));
    }
    if (std::filesystem::equivalent(group, mount, fault) || group == mount || !group.has_relative_path()) break;
  }
  return left;
}

std::string whole(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::uint64_t soft_limit(decltype(RLIMIT_AS) resource) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return no_limit;
  return limit.rlim_cur;
}

}  // namespace

std::uint64_t addresses_left() {
  const std::uint64_t addresses = soft_limit(RLIMIT_AS), data = soft_limit(RLIMIT_DATA);
  if (addresses == no_limit && data == no_limit) return no_limit;
  // Page counts: all, resident, shared, code, 0, data and stack, 0.
  std::ifstream in("/proc/self/statm");
  std::uint64_t all = 0, resident = 0, shared = 0, code = 0, library = 0, written = 0;
  if (!(in >> all >> resident >> shared >> code >> library >> written)) return no_limit;
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return std::min(addresses == no_limit ? no_limit : minus(addresses, all * page),
                  data == no_limit ? no_limit : minus(data, written * page));
}

std::uint64_t group_memory_left() {
  return group_memory_left(whole("/proc/self/cgroup"), "/sys/fs/cgroup");
}

// A line is NUMBER:CONTROLLER,CONTROLLER:PATH; in version 2 it is 0::PATH.
std::uint64_t group_memory_left(const std::string& groups, const std::filesystem::path& root) {
  std::uint64_t left = no_limit;
  std::istringstream lines(groups);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string path = line.substr(second + 1);
    std::istringstream controllers(line.substr(first + 1, second - first - 1));
    if (second == first + 1) left = std::min(left, left_in(root, path, version_2));
    for (std::string controller; std::getline(controllers, controller, ',');) {
      if (controller == "memory") left = std::min(left, left_in(root / "memory", path, version_1));
    }
  }
  return left;
}

}  // namespace palpa
