#include "base/system/memory.hpp"

#include <fmt/core.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <limits>

#include "base/error.hpp"
#include "base/system/memory_limits.hpp"

namespace palpa {

namespace {

std::uint64_t free_memory_of_machine() {
  std::ifstream file("/proc/meminfo");
  for (std::string name; file >> name;) {
    std::uint64_t kilobytes = 0;
    if (name == "MemAvailable:" && file >> kilobytes) return kilobytes * 1024;
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::numeric_limits<std::uint64_t>::max();
}

}  // namespace

std::uint64_t free_memory() {
  return std::min({free_memory_of_machine(), addresses_left(), group_memory_left()});
}

void require_memory(std::uint64_t bytes, const std::string& what, const std::string& remedy) {
  const std::uint64_t free = free_memory();
  if (bytes <= free / 10 * 9) return;
  throw failure(
      fmt::format("{} needs {} of memory, {} are free; {}", what, format_bytes(bytes), format_bytes(free), remedy));
}

void prefer_large_pages(const void* items, std::uint64_t bytes) {
  constexpr std::uintptr_t page = std::uintptr_t{2} << 20;
  const auto begin = reinterpret_cast<std::uintptr_t>(items);
  const std::uintptr_t first = (begin + page - 1) / page * page, end = (begin + bytes) / page * page;
  auto* const at = static_cast<std::byte*>(const_cast<void*>(items));
  if (end > first) ::madvise(at + (first - begin), end - first, MADV_HUGEPAGE);
}

std::string format_bytes(std::uint64_t bytes) {
  const auto size = static_cast<double>(bytes);
  return size < 1e9 ? fmt::format("{:.0f} MB", size / 1e6) : fmt::format("{:.1f} GB", size / 1e9);
}

}  // namespace palpa
