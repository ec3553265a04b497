// Reading files that may be anything: directories, devices, pipes and giants are refused before a byte is believed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpa::geometry {

/// A regular file, open for reading. Owns the descriptor.
class InputFile {
 public:
  /// Throws bad_input: missing, unreadable, not a regular file, empty. Never blocks (a FIFO is refused without
  /// waiting).
  explicit InputFile(const std::filesystem::path& path);
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

}  // namespace palpa::geometry
