#include "gpu/software.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "base/error.hpp"
#include "base/system/memory_limits.hpp"
#include "base/system/parallel.hpp"
#include "base/text.hpp"

namespace palpa::gpu {
namespace {

// Measured with Mesa 22.3's llvmpipe for the largest user, a live loop: 1.02, 1.17 and 1.47 GB with 1, 2 and 4 threads.
// The process has 0.24 GB of this when the driver is loaded, and 0.24 GB are in use.
constexpr std::uint64_t without_threads = 850'000'000, each_thread = 150'000'000, in_use = 256'000'000;
constexpr std::uint64_t spare = 100'000'000;         // compiled and mapped data besides buffers, in use
constexpr std::uint64_t driver_bytes = 220'000'000;  // until one of the drivers, Mesa's with LLVM in it, is loaded
constexpr unsigned most_threads = 32;

/// The number of threads that Mesa starts.
unsigned driver_threads() {
  unsigned count = worker_count();
  if (const char* const given = std::getenv("LP_NUM_THREADS")) {
    const std::string_view text = given;
    std::from_chars(text.data(), text.data() + text.size(), count);
  }
  return std::min(count, most_threads);
}

/// In one unit, so that values can be compared.
std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{} MB", bytes / 1'000'000);
}

std::string lacking(const DeviceDescription& device, std::uint64_t needed, std::uint64_t left) {
  if (left >= needed) return {};
  return fmt::format(
      "{} computes in this process's memory: it needs {} more, but the limits (ulimit -v, control group) leave {}; "
      "raise them",
      device.name, megabytes(needed), megabytes(left));
}

/// What the environment says about drivers, as advice; empty if it says nothing.
std::string chosen_drivers() {
  for (const char* name : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"}) {  // the loader's order
    const char* const value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    for (std::string_view rest = value; !rest.empty();) {
      const std::string_view file = rest.substr(0, rest.find(':'));
      rest.remove_prefix(std::min(rest.size(), file.size() + 1));
      std::error_code fault;
      if (!file.empty() && !std::filesystem::exists(file, fault))
        return fmt::format("{} names {}, which does not exist: correct or unset it", name, printable(file, 200));
    }
    return fmt::format("{} allows only the drivers of {}: name others, or unset it", name, printable(value, 200));
  }
  for (const char* name : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"}) {
    if (std::getenv(name) != nullptr)
      return fmt::format("{} is set, but empty, and so names no driver: unset it", name);
  }
  for (const char* name : {"VK_LOADER_DRIVERS_SELECT", "VK_LOADER_DRIVERS_DISABLE"}) {
    if (const char* const value = std::getenv(name); value != nullptr && *value != '\0')
      return fmt::format("{} is {}, which may leave out the drivers: unset it", name, printable(value, 200));
  }
  return {};
}

}  // namespace

bool is_software(const DeviceDescription& device) {
  return device.kind == "cpu";
}

std::uint64_t software_device_bytes(unsigned threads) {
  return without_threads + threads * each_thread;
}

std::string lacking_room(const DeviceDescription& device) {
  if (!is_software(device)) return {};
  const std::string addresses = lacking(device, software_device_bytes(driver_threads()), addresses_left());
  return addresses.empty() ? lacking(device, in_use, group_memory_left()) : addresses;
}

void require_room_for(const DeviceDescription& device) {
  if (const std::string fault = lacking_room(device); !fault.empty()) throw failure(fault);
}

void require_room_for(const DeviceDescription& device, std::uint64_t bytes) {
  if (!is_software(device)) return;
  if (const std::string fault = lacking(device, bytes + spare, addresses_left()); !fault.empty()) throw failure(fault);
}

bool drivers_fit() {
  return addresses_left() >= driver_bytes;
}

std::string driver_advice(const std::string& otherwise) {
  const std::uint64_t needed = software_device_bytes(driver_threads()), addresses = addresses_left();
  const bool group_is_tighter = addresses >= needed;
  const std::uint64_t enough = group_is_tighter ? in_use : needed,
                      left = group_is_tighter ? group_memory_left() : addresses;
  if (left >= enough) {
    const std::string chosen = chosen_drivers();
    return chosen.empty() ? otherwise : chosen;
  }
  return fmt::format(
      "a software driver needs {} of memory, but the limits (ulimit -v, control group) leave {}; raise them",
      megabytes(enough), megabytes(left));
}

}  // namespace palpa::gpu
