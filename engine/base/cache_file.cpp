#include "base/cache_file.hpp"

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

#include "base/log.hpp"
#include "base/output_file.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

// A file has the number of sections and the size of each (64 bits), the sections, each after zeros up to its alignment,
// and the hash of all bytes before it, of the version and of the key.
constexpr std::string_view version = "palpa-c2";
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

CacheHash begun(const CacheKey& key) {
  CacheHash hash;
  hash.add(version.data(), version.size());
  hash.add(key);
  return hash;
}

/// The sections; no memory if they are not whole.
CacheFile parsed(std::shared_ptr<const void> memory, std::size_t size, const CacheKey& key) {
  const auto* bytes = static_cast<const std::byte*>(memory.get());
  const auto word_at = [&](std::size_t at) {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes + at, word);
    return value;
  };
  if (size < word + sizeof(key)) return {};
  size -= sizeof(key);
  CacheHash hash = begun(key);
  hash.add(bytes, size);
  const std::uint64_t count = word_at(0);
  if (hash.key() != CacheKey{word_at(size), word_at(size + word)} || count >= size / word) return {};
  CacheFile file;
  std::size_t at = (1 + count) * word;
  for (std::size_t i = 1; i <= count; ++i) {
    const std::uint64_t length = word_at(i * word);
    at += padding(at);
    if (at > size || length > size - at) return {};
    file.sections.emplace_back(bytes + at, length);
    at += length;
  }
  file.memory = std::move(memory);
  return file;
}

XXH3_state_t* xxh_of(void* state) {
  return static_cast<XXH3_state_t*>(state);
}

}  // namespace

CacheHash::CacheHash() : state_(XXH3_createState(), [](void* state) { XXH3_freeState(xxh_of(state)); }) {
  XXH3_128bits_reset(xxh_of(state_.get()));
}

void CacheHash::add(const void* data, std::size_t bytes) {
  if (bytes > 0) XXH3_128bits_update(xxh_of(state_.get()), data, bytes);
}

CacheKey CacheHash::key() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(xxh_of(state_.get()));
  return {hash.high64, hash.low64};
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
  if (at != MAP_FAILED) file = parsed(std::shared_ptr<void>(at, [size](void* it) { ::munmap(it, size); }), size, key);
  if (file.memory) return std::make_shared<const CacheFile>(std::move(file));
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
    CacheHash hash = begun(key);
    std::size_t at = 0;
    const auto put = [&](const void* data, std::size_t bytes) {
      file.write({static_cast<const char*>(data), bytes});
      hash.add(data, bytes);
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
    const CacheKey whole = hash.key();
    put(whole.data(), sizeof(whole));
    file.finish();
  } catch (const Error& error) {
    log::debug(fmt::format("no cache: {}", error.what()));
  }
}

}  // namespace palpa
