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
#include <utility>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/file_register.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 8> magic{'p', 'a', 'l', 'p', 'a', '-', 'c', '1'};
constexpr std::uint64_t endian = 0x0102030405060708;
constexpr std::size_t alignment = 64;

struct Header {
  std::array<char, 8> magic;
  std::uint64_t endian;
  CacheKey key;
  std::uint64_t bytes;     // of the whole file
  std::uint64_t sections;  // followed by a Place for each
  std::uint64_t checksum;  // of everything after this header
  std::uint64_t unused;
};
static_assert(sizeof(Header) == alignment);

struct Place {
  std::uint64_t offset, bytes;
};

std::size_t aligned(std::size_t bytes) {
  return (bytes + alignment - 1) / alignment * alignment;
}

/// Empty if there is no cache.
fs::path folder() {
  const char* off = std::getenv("PALPA_CACHE");
  if (off != nullptr && std::string_view(off) == "off") return {};
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "palpa";
  const char* home = std::getenv("HOME");
  if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "palpa";
  return {};
}

fs::path file_for(const fs::path& where, std::string_view kind, const CacheKey& key) {
  return where / fmt::format("{}-{:016x}{:016x}", kind, key[0], key[1]);
}

struct Mapping {
  void* at = MAP_FAILED;
  std::size_t bytes = 0;

  Mapping() = default;
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping() {
    if (at != MAP_FAILED) munmap(at, bytes);
  }
};

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

}  // namespace

struct CacheHash::State {
  XXH3_state_t* xxh = XXH3_createState();
  State() { XXH3_128bits_reset(xxh); }
  ~State() { XXH3_freeState(xxh); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

CacheHash::CacheHash() : state_(std::make_unique<State>()) {}
CacheHash::~CacheHash() = default;

void CacheHash::add(const void* data, std::size_t bytes) {
  if (bytes > 0) XXH3_128bits_update(state_->xxh, data, bytes);
}

CacheKey CacheHash::key() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return {hash.high64, hash.low64};
}

std::shared_ptr<const CacheFile> load_cached(std::string_view kind, const CacheKey& key) {
  const fs::path where = folder();
  if (where.empty()) return nullptr;
  const fs::path path = file_for(where, kind, key);
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat info {};
  if (file.get() < 0 || fstat(file.get(), &info) != 0 || !S_ISREG(info.st_mode)) return nullptr;
  const auto size = static_cast<std::size_t>(info.st_size);
  const auto unusable = [&]() -> std::shared_ptr<const CacheFile> {
    log::debug(
        fmt::format("{}: not a complete cache file of this version; palpa makes its contents again", path.string()));
    return nullptr;
  };
  if (size < sizeof(Header)) return unusable();
  auto mapping = std::make_shared<Mapping>();
  mapping->bytes = size;
  mapping->at = mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file.get(), 0);
  if (mapping->at == MAP_FAILED) return unusable();
  const auto* bytes = static_cast<const std::byte*>(mapping->at);
  Header header{};
  std::memcpy(&header, bytes, sizeof(header));
  if (header.magic != magic || header.endian != endian || header.key != key || header.bytes != size ||
      header.sections > (size - sizeof(Header)) / sizeof(Place) ||
      header.checksum != XXH3_64bits(bytes + sizeof(Header), size - sizeof(Header))) {
    return unusable();
  }
  auto result = std::make_shared<CacheFile>();
  for (std::uint64_t i = 0; i < header.sections; ++i) {
    Place place{};
    std::memcpy(&place, bytes + sizeof(Header) + i * sizeof(Place), sizeof(place));
    if (place.offset % alignment != 0 || place.offset > size || place.bytes > size - place.offset) return unusable();
    result->sections_.emplace_back(bytes + place.offset, place.bytes);
  }
  result->memory_ = std::move(mapping);
  return result;
}

void store_cached(std::string_view kind, const CacheKey& key, std::span<const std::span<const std::byte>> sections) {
  const fs::path where = folder();
  if (where.empty()) return log::debug("no cache: PALPA_CACHE is off, or there is no home directory");
  std::vector<Place> places;
  std::size_t end = aligned(sizeof(Header) + sections.size() * sizeof(Place));
  const std::size_t head = end;
  for (const auto& section : sections) {
    places.push_back({end, section.size()});
    end = aligned(end + section.size());
  }
  static constexpr std::array<char, alignment> zeros{};
  const auto each_piece = [&](const auto& give) {
    give(places.data(), places.size() * sizeof(Place));
    give(zeros.data(), head - sizeof(Header) - places.size() * sizeof(Place));
    for (const auto& section : sections) {
      give(section.data(), section.size());
      give(zeros.data(), aligned(section.size()) - section.size());
    }
  };
  XXH3_state_t* sum = XXH3_createState();
  XXH3_64bits_reset(sum);
  each_piece([&](const void* data, std::size_t bytes) {
    if (bytes > 0) XXH3_64bits_update(sum, data, bytes);
  });
  const Header header{magic, endian, key, end, sections.size(), XXH3_64bits_digest(sum), 0};
  XXH3_freeState(sum);
  std::error_code ignored;
  fs::create_directories(where, ignored);
  try {
    const fs::path path = file_for(where, kind, key);
    file_register::add_own(path);
    OutputFile file(path);
    const auto write = [&](const void* data, std::size_t bytes) {
      file.write({static_cast<const char*>(data), bytes});
    };
    write(&header, sizeof(header));
    each_piece(write);
    file.finish();
  } catch (const Error& error) {
    log::debug(fmt::format("no cache: {}", error.what()));
  }
}

}  // namespace palpa
