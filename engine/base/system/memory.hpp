// How much memory is free, so that work that needs more is refused before it begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace palpa {

/// Bytes that this machine can give now without evicting other processes, and that this process's limits leave
/// (base/system/memory_limits.hpp). If nothing is known, the largest number.
std::uint64_t free_memory();

/// Throws failure, "WHAT needs 12.3 GB of memory, 7.9 GB are free; REMEDY", if `bytes` exceeds nine tenths of the free
/// memory.
void require_memory(std::uint64_t bytes, const std::string& what, const std::string& remedy);

/// Asks for large pages for `items`, a block of `bytes` that was not touched yet, if the block is large. The system
/// takes back gigabytes of small pages so slowly that a program on a busy machine ends seconds after Ctrl-C. Does
/// nothing if there are no large pages.
void prefer_large_pages(const void* items, std::uint64_t bytes);
/// Reserves room for `count` items in large pages.
template <typename Items>
void reserve_large(Items& items, std::size_t count) {
  items.reserve(count);
  prefer_large_pages(items.data(), items.capacity() * sizeof(*items.data()));
}

/// "12.3 GB", "45 MB".
std::string format_bytes(std::uint64_t bytes);

}  // namespace palpa
