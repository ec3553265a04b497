#include "base/sha256.hpp"

#include <sys/types.h>
// After sys/types.h, whose types it uses.
#include <sha2.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "base/input_file.hpp"

namespace palpa {
namespace {

class Digest {
 public:
  Digest() { SHA256Init(&state_); }
  void add(const void* bytes, std::size_t count) {
    SHA256Update(&state_, static_cast<const std::uint8_t*>(bytes), count);
  }
  std::string hex() {
    std::array<std::uint8_t, SHA256_DIGEST_LENGTH> bytes{};
    SHA256Final(bytes.data(), &state_);
    constexpr char digits[] = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : bytes) {
      text += digits[byte >> 4U];
      text += digits[byte & 15U];
    }
    return text;
  }

 private:
  SHA2_CTX state_{};
};

}  // namespace

std::string sha256(std::string_view bytes) {
  Digest digest;
  digest.add(bytes.data(), bytes.size());
  return digest.hex();
}

FileDigest sha256_of_file(const std::filesystem::path& path) {
  constexpr std::uint64_t piece = 1U << 20;
  const InputFile file(path);
  Digest digest;
  std::vector<unsigned char> buffer(std::min(piece, file.size()));
  for (std::uint64_t at = 0; at < file.size(); at += buffer.size()) {
    buffer.resize(std::min(piece, file.size() - at));
    file.read_at(at, buffer);
    digest.add(buffer.data(), buffer.size());
  }
  return {digest.hex(), file.size()};
}

}  // namespace palpa
