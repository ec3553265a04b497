#include "base/files/cache_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/files/output_file.hpp"
#include "base/log.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

// A file has the number of sections and the size of each (64 bits), the sections, each after zeros up to its alignment,
// and the hash of all bytes before it, which depends on the key, too.
constexpr std::uint64_t version = 2;
constexpr std::size_t alignment = 64, word = sizeof(std::uint64_t);

/// The bytes from there on up to the next aligned place.
std::size_t padding(std::size_t at) {
  return (alignment - at % alignment) % alignment;
}

/// Empty if there is no cache.
fs::path file_for(std::string_view kind, const CacheKey& key) {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value != nullptr ? value : "");
  };
  const fs::path cache = variable("XDG_CACHE_HOME"), home = variable("HOME");
  const fs::path folder = cache.is_absolute() ? cache : home / ".cache";
  if (variable("PALPA_CACHE") == "off" || !folder.is_absolute()) return {};
  return folder / "palpa" / fmt::format("{}-{:016x}{:016x}", kind, key[0], key[1]);
}

std::uint64_t seed_of(const CacheKey& key) {
  return key[0] ^ key[1] ^ version;
}

/// The sections of a file; empty if it is damaged or another one.
std::vector<std::span<const std::byte>> sections_in(std::span<const std::byte> bytes, const CacheKey& key) {
  const auto word_at = [&](std::size_t at) {
    std::uint64_t value = 0;
    std::memcpy(&value, &bytes[at], word);
    return value;
  };
  if (bytes.size() < 2 * word) return {};
  const std::size_t size = bytes.size() - word;
  const std::uint64_t count = word_at(0);
  if (word_at(size) != XXH3_64bits_withSeed(bytes.data(), size, seed_of(key)) || count >= size / word) return {};
  std::vector<std::span<const std::byte>> sections;
  std::size_t at = (1 + count) * word;
  for (std::size_t i = 1; i <= count; ++i) {
    const std::uint64_t length = word_at(i * word);
    at += padding(at);
    if (at > size || length > size - at) return {};
    sections.push_back(bytes.subspan(at, length));
    at += length;
  }
  return sections;
}

}  // namespace

void CacheHash::add(const void* data, std::size_t bytes) {
  const auto [low, high] = XXH3_128bits(data, bytes);
  const std::array pieces{key_[0], key_[1], high, low};
  const auto [next_low, next_high] = XXH3_128bits(pieces.data(), sizeof(pieces));
  key_ = {next_high, next_low};
}

std::shared_ptr<const CacheFile> load_cached(std::string_view kind, const CacheKey& key) {
  const fs::path path = file_for(kind, key);
  const int descriptor = path.empty() ? -1 : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return nullptr;
  struct stat info {};
  const bool is_file = ::fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode);
  const auto size = static_cast<std::size_t>(info.st_size);
  void* at = is_file ? ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, descriptor, 0) : MAP_FAILED;
  ::close(descriptor);
  CacheFile file;
  if (at != MAP_FAILED) {
    file.memory = std::shared_ptr<void>(at, [size](void* it) { ::munmap(it, size); });
    file.sections = sections_in({static_cast<const std::byte*>(at), size}, key);
  }
  if (!file.sections.empty()) return std::make_shared<const CacheFile>(std::move(file));
  if (is_file)
    log::debug(path.string() + ": not a complete cache file of this version; palpa makes its contents again");
  return nullptr;
}

void store_cached(std::string_view kind, const CacheKey& key, std::span<const std::span<const std::byte>> sections) {
  const fs::path path = file_for(kind, key);
  if (path.empty()) return log::debug("no cache: PALPA_CACHE is off, or there is no home directory");
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  try {
    add_own_file(path);
    OutputFile file(path);
    XXH3_state_t sum;
    XXH3_INITSTATE(&sum);
    XXH3_64bits_reset_withSeed(&sum, seed_of(key));
    std::size_t at = 0;
    const auto put = [&](const void* data, std::size_t bytes) {
      file.write({static_cast<const char*>(data), bytes});
      if (bytes > 0) XXH3_64bits_update(&sum, data, bytes);
      at += bytes;
    };
    std::vector<std::uint64_t> sizes{sections.size()};
    for (const std::span<const std::byte> section : sections)
      sizes.push_back(section.size());
    put(sizes.data(), sizes.size() * word);
    for (const std::span<const std::byte> section : sections) {
      put(std::array<char, alignment>{}.data(), padding(at));
      put(section.data(), section.size());
    }
    const std::uint64_t checksum = XXH3_64bits_digest(&sum);
    put(&checksum, word);
    file.finish();
  } catch (const Error& error) {
    log::debug(fmt::format("no cache: {}", error.what()));
  }
}

}  // namespace palpa
