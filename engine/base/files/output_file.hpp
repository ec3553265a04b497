// The only way in which palpa opens a file for writing: whole files (OutputFile), and files that are read while they
// grow (OpenFile). Callers that must not wait for a disk or a reader use base/files/stream_writer.hpp. Everything here
// asks first whether the file may be written (base/files/outputs.hpp), and throws the errors of that.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/files/outputs.hpp"

namespace palpa {

/// A file that is open for writing, and its name for messages.
class OpenFile {
 public:
  OpenFile() = default;
  /// Takes the result of open() or dup(). Throws write_failure() for errno if that is negative.
  OpenFile(std::string name, int descriptor);
  ~OpenFile();
  OpenFile(OpenFile&& other) noexcept { *this = std::move(other); }
  OpenFile& operator=(OpenFile&& other) noexcept;

  const std::string& name() const { return name_; }
  int descriptor() const { return descriptor_; }
  bool on_disk() const;  ///< whether it is a regular file
  /// Whether it is still the file of that name: it was neither removed nor replaced since.
  bool is_at(const std::filesystem::path& file) const;
  /// Blocks until all bytes are written, and if they are to be `kept`, until they are on the disk, also after a power
  /// cut. Otherwise (a full disk, a limit, a closed pipe), a file on a disk is left without them; throws failure().
  void write(std::string_view bytes, bool kept = false) const;
  /// Removes everything after the first `bytes` bytes.
  void cut(std::uint64_t bytes) const;
  /// Some file systems report a full disk only here. Throws as write().
  void close();

 private:
  std::string name_;
  int descriptor_ = -1;
};

/// How long to wait for a reader or a disk.
struct Patience {
  std::optional<double> seconds{};          ///< nullopt: without limit
  const std::atomic<bool>* stop = nullptr;  ///< ends the wait when it becomes true
};
/// The wait for a pipe's reader was stopped on request: by Patience::stop, or by a signal that the program catches.
class WaitEnded : public Error {
 public:
  using Error::Error;
};

/// Creates the file, or empties it; "-" is stdout. If its file system has locks, other writers are kept away until it
/// is closed, however that ends. Throws bad_usage if another one has it; failure(), also if nobody opens a named pipe
/// to read it in time. Without a limit, a line says after half a second that palpa waits.
OpenFile open_output(const std::filesystem::path& file, const Patience& patience = {});
/// The same for a file that grows by records that must not be lost. It is locked and not emptied. Throws failure() also
/// if it is no regular file, and on a file system without locks.
OpenFile open_to_append(const std::filesystem::path& file);

/// Temporary names begin so, with the process and a number.
inline constexpr std::string_view temporary_prefix = ".palpa-";

/// A file that is written completely or not at all. It is written without a name and put into its place by finish(), so
/// that a reader finds either the old or the new file, even if two processes write it. A killed program may leave a
/// file with a temporary name beside the place: on file systems without nameless files, and on all others if it is
/// killed in the microseconds in which the new file replaces another. Symbolic links are followed. A replaced file
/// keeps its mode, owner and group; a new one has the umask's; one in a personal folder is for its owner only. Nothing
/// is synchronised: after a power failure, the file system decides.
///
/// A file with several names would lose them, and a mount point cannot be replaced: finish() copies into these. Written
/// in place are devices, pipes and files that are already open; files that belong to somebody else, or to a group that
/// the program is not in; and files in a folder that takes no new files.
class OutputFile {
 public:
  /// "-" is stdout. Waits for the reader of a FIFO. Throws failure() naming the file.
  explicit OutputFile(const std::filesystem::path& file);
  /// Without finish(), an existing file is unchanged, and a new one does not exist.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws as OpenFile::write().
  void write(std::string_view bytes);
  /// Puts the file into its place. Throws as write().
  void finish();

 private:
  bool open_beside();
  void put_in_place();

  OutputPlace place_;
  std::filesystem::path beside_;  ///< the temporary name until the file is finished; empty if it has none
  bool is_beside_ = false;        ///< not written directly to its place
  OpenFile file_;
  std::string buffer_;
};

/// Writes all of `bytes` as a file, see OutputFile.
void write_file(const std::filesystem::path& file, std::string_view bytes);
/// Creates a folder in one that exists, in a personal folder for its owner only. False if it is there. Throws
/// failure().
bool make_folder(const std::filesystem::path& folder);
/// Lets only the owner read and write a file or folder. Without effect on links, on file systems without modes, and on
/// files of others.
void keep_to_owner(const std::filesystem::path& file);
/// Waits until what was written, and its name, are on the disk; for a folder, if its file system can do that.
void keep_file(const std::filesystem::path& file);

/// Blocks until all bytes are written, and counts them. Returns the code of the error, 0 for none.
int write_all(int descriptor, std::string_view bytes, std::size_t& written);

}  // namespace palpa
