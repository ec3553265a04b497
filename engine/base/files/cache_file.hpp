// Results that are slow to compute, kept between runs of the program.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace palpa {

/// 128 bits that identify a cached result.
using CacheKey = std::array<std::uint64_t, 2>;

/// Hashes pieces of bytes, one after the other (XXH3, 128 bits).
class CacheHash {
 public:
  void add(const void* data, std::size_t bytes);
  /// Hashes a value without padding.
  template <typename T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(&value, sizeof(value));
  }
  /// Hashes the number of values, then the values.
  template <typename T>
  void add(const std::vector<T>& values) {
    add(values.size());
    add(values.data(), values.size() * sizeof(T));
  }
  const CacheKey& key() const { return key_; }

 private:
  CacheKey key_{};
};

/// The contents of a cache file: sections of plain values, each aligned to 64 bytes.
struct CacheFile {
  std::shared_ptr<const void> memory;  ///< in which the sections are
  std::vector<std::span<const std::byte>> sections;

  /// The section as values of T; empty if its size is not a multiple of T's.
  template <typename T>
  std::span<const T> section_as(std::size_t i) const {
    const std::span<const std::byte> bytes = sections[i];
    if (bytes.size() % sizeof(T) != 0) return {};
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
};

/// The bytes of a vector or a string, as a section.
template <typename Values>
std::span<const std::byte> bytes_of(const Values& values) {
  return std::as_bytes(std::span(values.data(), values.size()));
}

/// Loads what store_cached stored under this kind and key: $XDG_CACHE_HOME/palpa/KIND-KEY, else
/// ~/.cache/palpa/KIND-KEY. Returns null if there is no such file, if PALPA_CACHE is "off", and if the file is
/// truncated, damaged (a checksum covers everything), of another version or not palpa's. `kind` is lower-case letters.
std::shared_ptr<const CacheFile> load_cached(std::string_view kind, const CacheKey& key);

/// Stores sections for later runs, so that no process ever sees half of them, even if two processes store the same key.
/// If nothing can be written, a debug line gives the reason.
void store_cached(std::string_view kind, const CacheKey& key, std::span<const std::span<const std::byte>> sections);

}  // namespace palpa
