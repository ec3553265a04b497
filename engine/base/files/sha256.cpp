#include "base/files/sha256.hpp"

#include <sys/types.h>
// After sys/types.h, whose types it uses.
#include <sha2.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/files/input_file.hpp"

namespace palpa {

struct Sha256::State {
  SHA2_CTX context{};
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
  SHA256Init(&state_->context);
}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::add(std::string_view bytes) {
  SHA256Update(&state_->context, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::string Sha256::hex() {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
  return SHA256End(&state_->context, digits.data());
}

std::string sha256(std::string_view bytes) {
  Sha256 digest;
  digest.add(bytes);
  return digest.hex();
}

std::string sha256_of_file(const std::filesystem::path& path) {
  constexpr std::uint64_t piece = 1U << 20;
  const InputFile file(path);
  Sha256 digest;
  std::vector<unsigned char> buffer(std::min(piece, file.size()));
  for (std::uint64_t at = 0; at < file.size(); at += buffer.size()) {
    buffer.resize(std::min(piece, file.size() - at));
    file.read_at(at, buffer);
    digest.add({reinterpret_cast<const char*>(buffer.data()), buffer.size()});
  }
  return digest.hex();
}

}  // namespace palpa
