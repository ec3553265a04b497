// Reading files that may be anything: directories, devices, pipes and giants are refused before a byte is believed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>

namespace palpa {

/// A regular file, open for reading. Owns the descriptor: what was examined is what is read, whatever happens to the
/// name meanwhile.
class InputFile {
 public:
  static constexpr std::uint64_t any_size = std::numeric_limits<std::uint64_t>::max();

  /// Throws bad_input: missing, unreadable, not a regular file, empty, of more than `most_bytes`; bad_usage for one
  /// that is to be written (see Outputs). Never blocks (a FIFO is refused without waiting).
  explicit InputFile(const std::filesystem::path& path, std::uint64_t most_bytes = any_size);
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  InputFile& operator=(InputFile&&) = delete;

  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }

  /// Fills `out` from the byte `offset` on. Throws bad_input where the file ends earlier or the disk fails.
  void read_at(std::uint64_t offset, std::span<unsigned char> out) const;
  /// The first bytes, at most `count`.
  std::string head(std::size_t count) const;

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// All of a file of at most `most_bytes`. Throws as InputFile does.
std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes);

}  // namespace palpa
