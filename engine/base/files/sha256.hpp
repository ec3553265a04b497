// SHA-256 (FIPS 180-4), by which results name the files that they were computed from.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace palpa {

/// 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);

/// The same of bytes that come piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;
  void add(std::string_view bytes);
  /// The digits for all bytes that were added. Nothing can be added afterwards.
  std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads the whole file, piece by piece. Throws bad_input as InputFile does; an empty file is refused.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace palpa
