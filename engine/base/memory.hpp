// How much memory there is, for work that should rather be refused than begun.
#pragma once

#include <cstdint>
#include <string>

namespace palpa {

/// Bytes that this machine can give now without pushing others out; nothing known: the largest number.
std::uint64_t free_memory();

/// Throws failure, "WHAT needs 12.3 GB of memory, 7.9 GB are free; REMEDY", where `bytes` are more than nine tenths of
/// what is free.
void require_memory(std::uint64_t bytes, const std::string& what, const std::string& remedy);

/// "12.3 GB", "45 MB".
std::string format_bytes(std::uint64_t bytes);

}  // namespace palpa
