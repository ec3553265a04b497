// A file that grows by records that must not be lost: a record is on the disk when add() returns, also after a power
// cut. Files that are written whole belong to base/output_file.hpp, streams to base/stream_writer.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpa {

class AppendFile {
 public:
  /// Opens the file, or creates it, and locks it against other processes and other objects. The folder must exist.
  /// Throws bad_usage if another one has it open; failure() if it is no regular file, cannot be written, or is on a
  /// file system without locks; and the errors of the register of files.
  explicit AppendFile(const std::filesystem::path& file);
  /// Ends the lock.
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }
  /// The whole content. Throws bad_input if it has more than `most_bytes`.
  std::string content(std::uint64_t most_bytes) const;
  /// Appends the record and waits until it is on the disk. Throws failure(), for example for a full disk; the file then
  /// ends with the record before.
  void add(std::string_view record);
  /// Removes everything after the first `bytes` bytes.
  void cut(std::uint64_t bytes);

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Waits until the names in a folder are on the disk, if its file system can do that.
void sync_folder(const std::filesystem::path& folder);
/// Waits until a file that was written whole, and its name, are on the disk. Throws failure().
void keep_file(const std::filesystem::path& file);

}  // namespace palpa
