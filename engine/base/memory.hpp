// How much memory there is, for work that should rather be refused than begun.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace palpa {

/// Bytes that this machine can give now without pushing others out, and that this process's limits leave
/// (base/memory_limits.hpp); nothing known: the largest number.
std::uint64_t free_memory();

/// Throws failure, "WHAT needs 12.3 GB of memory, 7.9 GB are free; REMEDY", where `bytes` are more than nine tenths of
/// what is free.
void require_memory(std::uint64_t bytes, const std::string& what, const std::string& remedy);

/// Asks for large pages where `items`, which have room for `bytes` and were not touched yet, take many: the system
/// takes back gigabytes of small ones so slowly that a program on a busy machine ends seconds after Ctrl-C. Does
/// nothing where there are none.
void prefer_large_pages(const void* items, std::uint64_t bytes);
/// Room for `count` items in large pages.
template <typename Items>
void reserve_large(Items& items, std::size_t count) {
  items.reserve(count);
  prefer_large_pages(items.data(), items.capacity() * sizeof(*items.data()));
}

/// "12.3 GB", "45 MB".
std::string format_bytes(std::uint64_t bytes);

}  // namespace palpa
