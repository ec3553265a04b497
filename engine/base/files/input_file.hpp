// Safe reading of arbitrary files: directories, devices, pipes and oversized files are refused before any byte is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace palpa {

/// A regular file, open for reading. It owns the descriptor, so the file that was checked is the file that is read,
/// even if the name changes meanwhile.
class InputFile {
 public:
  static constexpr std::uint64_t any_size = std::numeric_limits<std::uint64_t>::max();

  /// Throws bad_input if the file is missing, unreadable, not a regular file, empty, or larger than `most_bytes`;
  /// bad_usage if it is a declared output (see Outputs). Never blocks (a FIFO is refused without waiting).
  explicit InputFile(const std::filesystem::path& path, std::uint64_t most_bytes = any_size);
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  InputFile& operator=(InputFile&&) = delete;

  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }

  /// Fills `out` from the byte `offset` on. Throws bad_input if the file ends too early or the disk fails.
  void read_at(std::uint64_t offset, std::span<unsigned char> out) const;
  /// The first bytes of the file, at most `count`.
  std::string head(std::size_t count) const;

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// The whole of a file of at most `most_bytes`. Throws as InputFile does.
std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes);

/// The length of the byte order mark with which a text in UTF-8 begins: 3 or 0. Some editors and spreadsheets write it.
std::size_t mark_of(std::string_view text);

/// The text in the bytes of the file `name`: without its byte order mark. Throws bad_input, naming the file, for
/// UTF-16. All text that palpa reads passes through here.
std::string_view text_in(std::string_view bytes, const std::string& name);

/// The whole of a text. Throws as read_file and text_in do.
std::string read_text_file(const std::filesystem::path& path, std::uint64_t most_bytes);

}  // namespace palpa
