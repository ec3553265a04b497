#include "base/memory.hpp"

#include <fmt/core.h>

#include <fstream>
#include <limits>

#include "base/error.hpp"

namespace palpa {

std::uint64_t free_memory() {
  std::ifstream file("/proc/meminfo");
  for (std::string name; file >> name;) {
    std::uint64_t kilobytes = 0;
    if (name == "MemAvailable:" && file >> kilobytes) return kilobytes * 1024;
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::numeric_limits<std::uint64_t>::max();
}

void require_memory(std::uint64_t bytes, const std::string& what, const std::string& remedy) {
  const std::uint64_t free = free_memory();
  if (bytes <= free / 10 * 9) return;
  throw failure(
      fmt::format("{} needs {} of memory, {} are free; {}", what, format_bytes(bytes), format_bytes(free), remedy));
}

std::string format_bytes(std::uint64_t bytes) {
  const auto size = static_cast<double>(bytes);
  return size < 1e9 ? fmt::format("{:.0f} MB", size / 1e6) : fmt::format("{:.1f} GB", size / 1e9);
}

}  // namespace palpa
